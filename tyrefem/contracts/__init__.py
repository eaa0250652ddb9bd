"""The contracts that a user's own effect, law or answer keeps, and templates to begin from.

`tyrefem check my_effect.py` prints every contract in plain words; `tyrefem new effect` writes a template. One module
per kind of plugin; what is tried before every run stands with the bases in the rooms below.
"""

from __future__ import annotations

from tyrefem.contracts.check import CheckedFile, check_file
from tyrefem.contracts.contract import Contract
from tyrefem.contracts.template import TEMPLATES, template

__all__ = ["TEMPLATES", "CheckedFile", "Contract", "check_file", "template"]
