"""Files whose tests take longest: they begin first, see `conftest.py`."""

from __future__ import annotations

#: Files whose tests take longest, the longest first. They begin first: a long file at the end would leave all other
#: workers idle (``--no-loadscope-reorder`` keeps this order).
LONG = (
    "footprint/test_other_code.py",
    "hostile/test_every_command_killed.py",
    "hostile/test_odd_studies_of_every_command.py",
    "hostile/test_every_command_interrupted.py",
    "packaging/test_docs_commands.py",
    "architecture/test_walks.py",
    "hostile/test_every_command_answers.py",
    "diagnose/test_hidden_heat.py",
    "diagnose/test_partly.py",
    "cli/test_ctrl_c.py",
    "hostile/test_files_of_every_command.py",
    "packaging/test_installed_wheel.py",
    "diagnose/test_odd_run.py",
    "diagnose/test_better_law.py",
    "diagnose/test_left_out.py",
    "packaging/test_measured_rows.py",
    "diagnose/test_computed_wave.py",
    "diagnose/test_reduced_drives.py",
)
