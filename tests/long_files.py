"""Files whose tests take longest: they begin first, see `conftest.py`."""

from __future__ import annotations

#: Files whose tests take longest, the longest first. They begin first: a long file at the end would leave all other
#: workers idle (``--no-loadscope-reorder`` keeps this order).
LONG = (
    "hostile/test_every_command_killed.py",
    "packaging/test_docs_python.py",
    "hostile/test_every_command_answers.py",
    "packaging/test_docs_commands.py",
    "diagnose/test_hidden_heat.py",
    "studies/test_example_structural.py",
    "diagnose/test_reduced_drives.py",
    "sliding/test_rolling_drive.py",
    "compare/test_changed_cycles.py",
    "cli/test_ctrl_c.py",
    "sizes/test_inflated_shape.py",
    "studies/test_shipped_runs.py",
    "hostile/test_every_command_interrupted.py",
    "hostile/test_odd_studies_of_every_command.py",
    "architecture/test_walks.py",
    "diagnose/test_noise.py",
    "packaging/test_installed_wheel.py",
    "diagnose/test_odd_run.py",
    "rolling/test_rolling_vtk.py",
    "hostile/test_files_of_every_command.py",
    "footprint/test_other_code.py",
    "packaging/test_measured_rows.py",
    "studies/test_hidden_effect.py",
    "diagnose/test_left_out.py",
    "diagnose/test_partly.py",
    "diagnose/test_better_law.py",
    "diagnose/test_computed_wave.py",
)
