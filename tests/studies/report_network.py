"""The NASA report's own thermal model: a network of 33 elements in a slice 1 cm thick (Clark & Dodge 1980, appendix I).

The elements and areas are those of tables H1 and H2, beside this file. The heat is the product's, at the elements'
nodes. Everything else is written again from the report, so that the two models differ in geometry and scheme alone.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp

TABLES = {"8PR": "nasa_table_h1_22x5.5_8pr.csv", "12PR": "nasa_table_h2_22x5.5_12pr.csv"}
INCH, CM, CM2, CAL = 0.0254, 1e-2, 1e-4, 41840.0  # m, m, m2, W/m2/K of 1 cal/(cm2 s K)
CONDUCTIVITY, HEAT_CAPACITY = 0.2092, 2.092e6  # W/m/K, J/m3/K
ROAD, GAS, RIM = 0.25 * CAL, 1e-4 * CAL, 0.5 * CAL  # films, W/m2/K
#: Rows under the tread, by number from the bead; on the road for a tenth of the revolution.
ON_ROAD = (7, 8, 9, 10)
#: hc A / (Cc rho_c V), 1/s, with the report's A = 30.4 cm2 and V = 90.35 cm3 of a slice.
GAS_RATE = GAS * 30.4e-4 / (0.24 * 4184 * 1.3 * 90.35e-6)
AMBIENT, SPEED = 25.0, 20 * 0.44704  # degC, m/s


def rows(ply_rating, column):
    """A column of the table, (11,) from bead to crown: the value of the row's inside element, SI."""
    return table(ply_rating, column)[:, 0]


def table(ply_rating, column):
    """A column of the table, (11 rows, 3 elements from inside to outside), SI."""
    values = pd.read_csv(Path(__file__).with_name(TABLES[ply_rating]))[column].to_numpy(float).reshape(11, 3)
    return values * {"cm2": CM2, "cm": CM, "in": INCH}[column.rsplit("_", 1)[1]]


def nodes(ply_rating, section):
    """Meridian distance and depth of the nodes, (11, 3) m. The outer ones have the middle one's distance."""
    s, depth = table(ply_rating, "YS_in"), table(ply_rating, "Y_in")
    s[:, 2] = s[:, 1]
    return np.minimum(s, 0.999 * section.line.length), depth


def in_series(area, *layers):
    """Conductance, W/K, through an area of layers given as W/m2/K."""
    return area / sum(1 / layer for layer in layers)


class Slice:
    """The report's slice 1 cm thick, with the strain energy of a tyre's first load case as its heat.

    ``revolved`` weights every area and volume with its radius, as a tyre has it; the report's slice is flat.
    """

    def __init__(self, ply_rating, tyre, revolved=False):
        study, schedule = tyre.study, tyre.schedule
        section, cycle = study.section, schedule.cycles[0][0]
        s, depth = nodes(ply_rating, section)
        places = section.place(s, depth)
        self.materials, self.regions = study.materials, section.region_at(s, depth)
        self.energy = np.zeros((11, 3))
        for zone in schedule.zones:
            inside = (self.regions == zone.region) & (s >= zone.start) & (s < zone.end)
            self.energy[inside] = cycle.energy_density(zone.name, places[inside].T)
        radius = places[..., 0] if revolved else np.ones((11, 3))
        LH, LV, DH, DV, AA, DA = (
            table(ply_rating, name) for name in ("LH_cm2", "LV_cm2", "DH_cm", "DV_cm", "AA_cm2", "DA_cm")
        )
        AC, DC = rows(ply_rating, "AC_cm2"), rows(ply_rating, "DC_cm")
        self.volume = LH * LV / CM * radius  # m3 of a slice 1 cm thick
        self.through = CONDUCTIVITY * LH[:, :2] * radius[:, :2] / DH[:, :2]
        self.along = CONDUCTIVITY * (LV * radius)[:-1] / DV[:-1]
        self.to_gas = in_series(AC, CONDUCTIVITY / DC, GAS) * radius[:, 0]
        self.inner = AC * radius[:, 0] / np.sum(AC * radius[:, 0])
        self.outer_radius, self.area, self.depth = radius[:, 2], AA[:, 0], DA[:, 0]
        self.on_rim = np.isnan(AA[:, 0])
        half = LV[:, 2] / CM / 2
        self.to_rim = np.where(self.on_rim, in_series(LH[:, 2], CONDUCTIVITY / half, RIM), 0.0) * radius[:, 2]

    def heat(self, T, revolutions):
        """(11, 3) W/m3 at so many revolutions per second."""
        lost = np.zeros((11, 3))
        for region in np.unique(self.regions):
            of_region = self.regions == region
            lost[of_region] = self.energy[of_region] * self.materials[region].loss_tangent(T[of_region])
        return math.pi * revolutions * lost

    def rate(self, state, revolutions, speed, ambient, *, road=0.0, rim=0.0, wind=0.0):
        """d(state)/dt of the temperatures (33) and the contained air: road and rim so much warmer than the ambient, K;
        wind beyond the tyre's speed, m/s. At rest no part is on the road."""
        T, gas = state[:-1].reshape(11, 3), state[-1]
        power = self.heat(T, revolutions) * self.volume
        flow = self.through * np.diff(T, axis=1)
        power[:, :2] += flow
        power[:, 1:] -= flow
        flow = self.along * np.diff(T, axis=0)
        power[:-1] += flow
        power[1:] -= flow
        power[:, 0] += self.to_gas * (gas - T[:, 0])
        power[:, 2] += self.to_rim * (ambient + rim - T[:, 2])
        film = (1.3e-4 + 4e-7 * 100 * (speed + wind)) * CAL
        for row in np.flatnonzero(~self.on_rim):
            to_air, to_road = (in_series(self.area[row], CONDUCTIVITY / self.depth[row], each) for each in (film, ROAD))
            share = 0.1 if row in ON_ROAD and speed > 0 else 0.0
            outward = (1 - share) * to_air * (ambient - T[row, 2]) + share * to_road * (ambient + road - T[row, 2])
            power[row, 2] += self.outer_radius[row] * outward
        gas_rate = GAS_RATE * (self.inner @ T[:, 0] - gas)
        return np.append(power / (HEAT_CAPACITY * self.volume), gas_rate)


def network(ply_rating, result, revolved=False, duration=600.0):
    """Element temperatures (11, 3) and that of the contained air, degC, at the end of free rolling.

    ``result`` is a run of the same study; its strain energy and loss tangent give the heat.
    """
    model = Slice(ply_rating, result.tyre, revolved)
    revolutions = result.tyre.schedule.revolutions_per_second(0.0)

    def rate(_time, state):
        return model.rate(state, revolutions, SPEED, AMBIENT)

    end = solve_ivp(rate, (0.0, duration), np.full(34, AMBIENT), method="BDF", rtol=1e-6).y[:, -1]
    return end[:-1].reshape(11, 3), float(end[-1])
