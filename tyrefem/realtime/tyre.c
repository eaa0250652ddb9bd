/* A tyre's temperatures as an FMI 2.0 co-simulation unit: the same arithmetic as tyrefem/realtime/tyre.py, nothing
   else needed. tyre_data.h holds the numbers of one tyre. Standard C99; link with the mathematics library. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tyre_data.h"

/* What this unit uses of the FMI 2.0 interface. */
typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Char, fmi2Byte;
typedef const fmi2Char *fmi2String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef void (*fmi2Logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
typedef struct {
    fmi2Logger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined(FMI2_FUNCTION_PREFIX)
#define PASTE(a, b) a##b
#define PASTED(a, b) PASTE(a, b)
#define FMI(name) PASTED(FMI2_FUNCTION_PREFIX, name)
#define EXPORT
#elif defined(_WIN32)
#define FMI(name) name
#define EXPORT __declspec(dllexport)
#else
#define FMI(name) name
#define EXPORT __attribute__((visibility("default")))
#endif

enum { INPUTS = 5, INITIAL = 5, CLAMP = 6, OUTSIDE = 7, OUTPUT = 10 };
#define ATMOSPHERE 101325.0
#define KELVIN 273.15

/* All that the next step and the outputs depend on. */
typedef struct {
    double time, start, filled, air_start;
    double held[INPUTS];         /* inputs of the last step */
    double inputs[INPUTS];       /* inputs at the start of the next one, and how they change, 1/s */
    double slope[INPUTS];
    double y[N], late[NREAD];
    int stepped, clamp, outside;
} State;

typedef struct {
    State s;
    fmi2CallbackFunctions call;
    char *name;
    int known;                   /* does what follows belong to these? */
    double h, key[3], filled;
    double A[N * N], U[N * N], sinks[4][N], heat[NSAMPLES], mass[N];
} Tyre;

static void say(Tyre *t, fmi2Status status, const char *text) {
    if (t->call.logger)
        t->call.logger(t->call.componentEnvironment, t->name, status, status == fmi2Warning ? "logStatusWarning" : "logStatusError", "%s", text);
}

static void start_at(Tyre *t, double temperature) {
    State *s = &t->s;
    s->time = 0.0;
    s->start = temperature;
    s->filled = 0.0;
    s->stepped = s->outside = t->known = 0;
    for (int i = 0; i < M; i++) s->y[i] = temperature * EVEN[i];
    for (int i = M; i < N; i++) s->y[i] = LUMPED_GIVEN[i - M] ? LUMPED_START[i - M] : temperature;
    for (int i = 0; i < NREAD; i++) s->late[i] = temperature;
    s->air_start = HAS_GAS ? s->y[M] : HELD;
}

static void weights(double u, int width, double *w) {
    if (width == 4) {
        double a = u - 1, b = u - 2, c = u - 3;
        w[0] = a * b * c / -6; w[1] = u * b * c / 2; w[2] = u * a * c / -2; w[3] = u * a * b / 6;
    } else if (width == 3) {
        w[0] = (u - 1) * (u - 2) / 2; w[1] = u * (2 - u); w[2] = u * (u - 1) / 2;
    } else if (width == 2) {
        w[0] = 1 - u; w[1] = u;
    } else {
        w[0] = 1;
    }
}

/* Values on even axes (low, high, points): cubic through the four nearest points of every axis. */
static void look_up(const double *table, const double axes[][3], int dimensions, const double *place, int count, double *found) {
    int first[3] = {0, 0, 0}, width[3] = {1, 1, 1}, points[3] = {1, 1, 1};
    double w[3][4] = {{1}, {1}, {1}};
    for (int d = 0; d < dimensions; d++) {
        int k = 3 - dimensions + d, n = (int)axes[d][2];
        points[k] = n;
        if (n == 1) continue;
        double u = (place[d] - axes[d][0]) / (axes[d][1] - axes[d][0]) * (n - 1);
        width[k] = n < 4 ? n : 4;
        first[k] = (int)u - 1;
        if (first[k] > n - width[k]) first[k] = n - width[k];
        if (first[k] < 0) first[k] = 0;
        weights(u - first[k], width[k], w[k]);
    }
    for (int i = 0; i < count; i++) found[i] = 0.0;
    for (int a = 0; a < width[0]; a++)
        for (int b = 0; b < width[1]; b++)
            for (int c = 0; c < width[2]; c++) {
                double each = w[0][a] * w[1][b] * w[2][c];
                size_t row = ((size_t)(first[0] + a) * points[1] + first[1] + b) * points[2] + first[2] + c;
                for (int i = 0; i < count; i++) found[i] += each * table[row * count + i];
            }
}

/* Root of the deflection. */
static double bent(const double *inputs) {
    double place[2] = {sqrt(inputs[1]), inputs[2]}, found;
    look_up(BEND_TABLE, BEND_AXES, 2, place, 1, &found);
    return found;
}

static void heat_per_metre(const double *inputs, double *found) {
    double place[2] = {bent(inputs), inputs[2]};
    look_up(HEAT_TABLE, HEAT_AXES, 2, place, NSAMPLES, found);
}

/* y += a x */
static void add(int n, double a, const double *x, double *y) {
    for (int i = 0; i < n; i++) y[i] += a * x[i];
}

static double dot(int n, const double *x, const double *y) {
    double a = 0, b = 0, c = 0, d = 0;
    int i = 0;
    for (; i + 3 < n; i += 4) {
        a += x[i] * y[i]; b += x[i + 1] * y[i + 1]; c += x[i + 2] * y[i + 2]; d += x[i + 3] * y[i + 3];
    }
    for (; i < n; i++) a += x[i] * y[i];
    return (a + b) + (c + d);
}

/* Matrix of a step at a speed, load and pressure, and its Cholesky factor; 0 if it is not positive. */
static int prepare(Tyre *t, double h, const double *u) {
    State *s = &t->s;
    if (t->known && t->h == h && t->filled == s->filled && !memcmp(t->key, u, sizeof t->key)) return 1;
    double films[NEXCHANGES], place[3] = {sqrt(u[0]), bent(u), u[2]};
    look_up(FILM_TABLE, FILM_AXES, 3, place, NEXCHANGES, films);
    if (u[0] < STANDSTILL) memcpy(films, FILM_STANDING, sizeof films);
    memset(t->A, 0, sizeof t->A);
    memset(t->sinks, 0, sizeof t->sinks);
    for (int j = 0; j < NEXCHANGES; j++) {
        add(N * N, films[j], EXCHANGE[j], t->A);
        for (int k = 0; k < 4; k++) add(N, films[j] * SINK[j][k], EXCHANGE_LOAD[j], t->sinks[k]);
    }
    for (int i = 0; i < M; i++) {
        t->A[i * N + i] += RATES[i];
        t->mass[i] = 1.0;
    }
    for (int i = M; i < N; i++) t->mass[i] = CAPACITY[i - M];
    if (HAS_GAS) t->mass[M] = GAS[0] + GAS[1] * (s->filled + ATMOSPHERE) / (s->air_start + KELVIN);
    for (int i = 0; i < N * N; i++) t->U[i] = GAMMA * h * t->A[i];
    for (int i = 0; i < N; i++) t->U[i * N + i] += t->mass[i];
    for (int k = 0; k < N; k++) {
        double *row = t->U + k * N;
        if (!(row[k] > 0)) return 0;
        row[k] = sqrt(row[k]);
        for (int j = k + 1; j < N; j++) row[j] /= row[k];
        for (int i = k + 1; i < N; i++) add(N - i, -row[i], row + i, t->U + i * N + i);
    }
    heat_per_metre(u, t->heat);
    for (int i = 0; i < NSAMPLES; i++) t->heat[i] *= u[0];
    t->h = h;
    t->filled = s->filled;
    memcpy(t->key, u, sizeof t->key);
    return t->known = 1;
}

/* x := (U' U)^-1 x */
static void solve(const double *U, double *x) {
    for (int k = 0; k < N; k++) {
        x[k] /= U[k * N + k];
        add(N - k - 1, -x[k], U + k * N + k + 1, x + k + 1);
    }
    for (int k = N - 1; k >= 0; k--) x[k] = (x[k] - dot(N - k - 1, U + k * N + k + 1, x + k + 1)) / U[k * N + k];
}

/* Heat at the samples: tan delta from its table, times what one unit of it makes. */
static void make_heat(const double *heat, const double *y, double *made) {
    for (int i = 0; i < NSAMPLES; i++) {
        double place = (dot(M, AT_SAMPLES[i], y) - LOSS_COLD) * LOSS_PER_KELVIN;
        if (!(place > 0)) place = 0;
        if (place > NLOSS - 1.001) place = NLOSS - 1.001;
        int left = (int)place;
        const double *table = LOSS[LOSS_ROW[i]] + left;
        made[i] = heat[i] * (table[0] + (place - left) * (table[1] - table[0]));
    }
}

/* Heat from what surrounds the tyre: (1, ambient, road, start). */
static void surroundings(const Tyre *t, const double *inputs, double *found) {
    for (int i = 0; i < N; i++)
        found[i] = t->sinks[0][i] + t->sinks[1][i] * inputs[3] + t->sinks[2][i] * inputs[4] + t->sinks[3][i] * t->s.start;
}

static int step(Tyre *t, double h, const double *first, const double *last) {
    State *s = &t->s;
    double before[NREAD], rate[N], made[NSAMPLES], later[NSAMPLES], more[N], guess[N], mean[3], now[N], then[N];
    for (int i = 0; i < 3; i++) mean[i] = (first[i] + last[i]) / 2;
    if (!prepare(t, h, mean)) return 0;
    surroundings(t, first, now);
    surroundings(t, last, then);
    for (int i = 0; i < NSENSORS; i++) before[i] = dot(N, READ[i], s->y);
    for (int i = 0; i < N; i++) rate[i] = now[i] - dot(N, t->A + i * N, s->y);
    make_heat(t->heat, s->y, made);
    for (int i = 0; i < M; i++) rate[i] += dot(NSAMPLES, HEATING[i], made);
    memcpy(guess, s->y, sizeof guess);
    for (int j = 0; j < NPHI; j++) {
        if (j) for (int i = 0; i < N; i++) rate[i] *= t->mass[i];
        solve(t->U, rate);
        add(N, h * PHI[j], rate, guess);
    }
    make_heat(t->heat, guess, later);
    for (int i = 0; i < NSAMPLES; i++) later[i] -= made[i];
    for (int i = 0; i < N; i++) more[i] = then[i] - now[i] + (i < M ? dot(NSAMPLES, HEATING[i], later) : 0.0);
    for (int j = 0; j < NPHI_2; j++) {
        if (j) for (int i = 0; i < N; i++) more[i] *= t->mass[i];
        solve(t->U, more);
        add(N, h * PHI_2[j], more, guess);
    }
    memcpy(s->y, guess, sizeof guess);
    s->time += h;
    for (int i = 0; i < NSENSORS; i++)
        if (LAG[i] > 0) {
            double after = dot(N, READ[i], s->y), behind = LAG[i] * (after - before[i]) / h;
            s->late[i] = after - behind + (s->late[i] - before[i] + behind) * exp(-h / LAG[i]);
        }
    return 1;
}

static double output(Tyre *t, int number) {
    State *s = &t->s;
    const double *inputs = s->stepped ? s->held : s->inputs;
    double air = HAS_GAS ? s->y[M] : s->air_start, found;
    if (number < NSENSORS) return LAG[number] > 0 ? s->late[number] : dot(N, READ[number], s->y);
    switch (number - NSENSORS) {
    case 0:
        return air;
    case 1:
        found = -1e300;
        for (int i = 0; i < NHOT; i++) {
            double one = dot(M, HOT[i], s->y);
            if (one > found) found = one;
        }
        return found;
    case 2:
        return (inputs[2] + ATMOSPHERE) * (air + KELVIN) / (s->air_start + KELVIN) - ATMOSPHERE;
    default: {
        double heat[NSAMPLES], made[NSAMPLES];
        if (inputs[0] < STANDSTILL) return 0.0;
        heat_per_metre(inputs, heat);
        make_heat(heat, s->y, made);
        return dot(NSAMPLES, POWER, made);
    }
    }
}

/* ---- the interface ---- */

EXPORT const char *FMI(fmi2GetTypesPlatform)(void) { return "default"; }
EXPORT const char *FMI(fmi2GetVersion)(void) { return "2.0"; }
EXPORT fmi2Status FMI(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    (void)c; (void)on; (void)n; (void)categories;
    return fmi2OK;
}

static void defaults(Tyre *t) {
    memset(&t->s, 0, sizeof t->s);
    memcpy(t->s.inputs, INPUT_START, sizeof t->s.inputs);
    start_at(t, INITIAL_TEMPERATURE);
}

EXPORT fmi2Component FMI(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    (void)resources; (void)visible; (void)logging;
    Tyre *t = calloc(1, sizeof *t);
    if (!t) return NULL;
    if (functions) t->call = *functions;
    t->name = calloc(strlen(name ? name : "") + 1, 1);
    if (t->name) strcpy(t->name, name ? name : "");
    if (type != fmi2CoSimulation || !guid || strcmp(guid, GUID)) {
        say(t, fmi2Error, type != fmi2CoSimulation ? "this unit is for co-simulation" : "the GUID is not that of this unit");
        free(t->name);
        free(t);
        return NULL;
    }
    defaults(t);
    return t;
}

EXPORT void FMI(fmi2FreeInstance)(fmi2Component c) {
    if (c) {
        free(((Tyre *)c)->name);
        free(c);
    }
}

EXPORT fmi2Status FMI(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                                           fmi2Boolean has_stop, fmi2Real stop) {
    (void)c; (void)has_tolerance; (void)tolerance; (void)start; (void)has_stop; (void)stop;
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2EnterInitializationMode)(fmi2Component c) { (void)c; return fmi2OK; }
EXPORT fmi2Status FMI(fmi2ExitInitializationMode)(fmi2Component c) { (void)c; return fmi2OK; }
EXPORT fmi2Status FMI(fmi2Terminate)(fmi2Component c) { (void)c; return fmi2OK; }
EXPORT fmi2Status FMI(fmi2Reset)(fmi2Component c) { defaults(c); return fmi2OK; }

static fmi2Status unknown(Tyre *t) {
    say(t, fmi2Error, "no variable of this kind has this value reference");
    return fmi2Error;
}

EXPORT fmi2Status FMI(fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    Tyre *t = c;
    for (size_t i = 0; i < n; i++) {
        if (vr[i] < INPUTS) value[i] = t->s.inputs[vr[i]];
        else if (vr[i] == INITIAL) value[i] = t->s.start;
        else if (vr[i] >= OUTPUT && vr[i] < OUTPUT + NSENSORS + 4) value[i] = output(t, (int)(vr[i] - OUTPUT));
        else return unknown(t);
    }
    return fmi2OK;
}

EXPORT fmi2Status FMI(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Tyre *t = c;
    for (size_t i = 0; i < n; i++) {
        if (vr[i] < INPUTS) {
            t->s.inputs[vr[i]] = value[i];
            t->s.slope[vr[i]] = 0.0; /* held, unless its derivative follows */
        }
        else if (vr[i] == INITIAL) {
            if (!isfinite(value[i])) {
                say(t, fmi2Error, "initial_temperature is not a number");
                return fmi2Error;
            }
            start_at(t, value[i]);
        }
        else return unknown(t);
    }
    return fmi2OK;
}

EXPORT fmi2Status FMI(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] != OUTSIDE) return unknown(c);
        value[i] = ((Tyre *)c)->s.outside;
    }
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[]) {
    (void)vr; (void)value;
    return n ? unknown(c) : fmi2OK;
}
EXPORT fmi2Status FMI(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] != CLAMP) return unknown(c);
        value[i] = ((Tyre *)c)->s.clamp;
    }
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] != CLAMP) return unknown(c);
        ((Tyre *)c)->s.clamp = value[i] != 0;
    }
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr; (void)value;
    return n ? unknown(c) : fmi2OK;
}
EXPORT fmi2Status FMI(fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    (void)vr; (void)value;
    return n ? unknown(c) : fmi2OK;
}

EXPORT fmi2Status FMI(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    if (!*state) *state = malloc(sizeof(State));
    if (!*state) return fmi2Error;
    memcpy(*state, &((Tyre *)c)->s, sizeof(State));
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    memcpy(&((Tyre *)c)->s, state, sizeof(State));
    ((Tyre *)c)->known = 0;
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)c; (void)state;
    *size = sizeof(State);
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (size < sizeof(State)) return fmi2Error;
    (void)c;
    memcpy(bytes, state, sizeof(State));
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    if (size != sizeof(State)) return fmi2Error;
    (void)c;
    if (!*state) *state = malloc(sizeof(State));
    if (!*state) return fmi2Error;
    memcpy(*state, bytes, sizeof(State));
    return fmi2OK;
}

EXPORT fmi2Status FMI(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                                    const fmi2ValueReference k[], size_t nk, const fmi2Real du[], fmi2Real dk[]) {
    (void)c; (void)u; (void)nu; (void)k; (void)nk; (void)du; (void)dk;
    return fmi2Error;
}
EXPORT fmi2Status FMI(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= INPUTS || order[i] != 1) return unknown(c);
        ((Tyre *)c)->s.slope[vr[i]] = value[i];
    }
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
    (void)c; (void)vr; (void)n; (void)order; (void)value;
    return fmi2Error;
}

EXPORT fmi2Status FMI(fmi2DoStep)(fmi2Component c, fmi2Real now, fmi2Real dt, fmi2Boolean keep) {
    static const char *const names[INPUTS] = {"speed", "load", "pressure", "ambient", "road_temperature"};
    static const char *const units[INPUTS] = {"m/s", "N", "Pa", "degC", "degC"};  /* as in modelDescription.xml */
    Tyre *t = c;
    State *s = &t->s;
    double ends[2][INPUTS];
    int outside = 0;
    char text[200];
    (void)now; (void)keep;
    if (!(dt > 0) || !isfinite(dt)) {
        say(t, fmi2Error, "a step must be positive");
        return fmi2Error;
    }
    for (int i = 0; i < INPUTS; i++) {
        double low = BOX[i][0], high = BOX[i][1], near = 1e-9 * fmax(fabs(low), fabs(high));
        int moved = 0;
        for (int k = 0; k < 2; k++) {
            double value = s->inputs[i] + k * dt * s->slope[i];
            if (!(value >= low - near && value <= high + near)) {
                snprintf(text, sizeof text, "%s = %.7g %s is outside %.7g to %.7g %s, the certified range%s", names[i],
                         value, units[i], low, high, units[i], s->clamp && !isnan(value) ? "; its edge is taken" : "");
                if (!s->clamp || isnan(value)) {
                    say(t, fmi2Error, text);
                    return fmi2Error;
                }
                if (!s->outside && !moved) say(t, fmi2Warning, text);
                moved = 1;
            }
            ends[k][i] = fmin(fmax(value, low), high);
        }
        outside += moved;
    }
    s->outside = outside;
    if (!s->stepped) s->filled = ends[0][2];
    s->stepped = 1;
    int parts = (int)ceil(dt / LONGEST - 1e-9);
    if (parts < 1) parts = 1;
    for (int p = 0; p < parts; p++) {
        double first[INPUTS], last[INPUTS];
        for (int i = 0; i < INPUTS; i++) {
            first[i] = ends[0][i] + (ends[1][i] - ends[0][i]) * p / parts;
            last[i] = ends[0][i] + (ends[1][i] - ends[0][i]) * (p + 1) / parts;
        }
        if (!step(t, dt / parts, first, last)) {
            say(t, fmi2Error, "the matrix of a step is not positive");
            return fmi2Error;
        }
    }
    memcpy(s->held, ends[1], sizeof s->held);
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2CancelStep)(fmi2Component c) { (void)c; return fmi2Error; }
EXPORT fmi2Status FMI(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}
EXPORT fmi2Status FMI(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = ((Tyre *)c)->s.time;
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}
EXPORT fmi2Status FMI(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    (void)c;
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = 0;
    return fmi2OK;
}
EXPORT fmi2Status FMI(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}
