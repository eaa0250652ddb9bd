"""``python -m tyrefem``."""

from tyrefem.cli import main

if __name__ == "__main__":
    main()
