"""What people add without editing this package: own effects, laws and answers, in files or installed packages.

Files are loaded only from the folders that the user names in ``TYREFEM_PLUGINS`` (or ``TYREFEM_EFFECTS``, its older
name), packages by their entry points of the group ``tyrefem``. The room knows no effect and no law: a base class says
by its `Kind` what its subclasses need.
"""

from __future__ import annotations

from tyrefem.plugins.kind import Kind
from tyrefem.plugins.origin import Origin
from tyrefem.plugins.registry import Failure, Plugin, Registry, registry
from tyrefem.plugins.sent import Sent, receive, sent, use
from tyrefem.plugins.trial import Range, Trial, trial, working

__all__ = [
    "Failure",
    "Kind",
    "Origin",
    "Plugin",
    "Range",
    "Registry",
    "Sent",
    "Trial",
    "receive",
    "registry",
    "sent",
    "trial",
    "use",
    "working",
]
