"""``python -m tyrefem``."""

from tyrefem.cli import main

main()
