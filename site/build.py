"""Build the documentation as a site: `python site/build.py`, then open site/_build/html/index.html.

The pages of `docs/` stay where they are. They are copied beside the pages of this folder into ``site/_build/source``,
in the places that they have in the repository, so that their links hold as on a code host. Sphinx makes the site of
that. Examples and verification cases run while the site is built. Every warning is an error.

    python site/build.py                 # all of it; only what changed runs again
    python site/build.py --no-run        # examples are shown, not run
    python site/build.py --links         # only checks links to other servers; without a network it says so

Links between the site's own pages are checked by every build.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import re
import shutil
import sys
from pathlib import Path

SITE = Path(__file__).resolve().parent
ROOT = SITE.parent
BUILD = SITE / "_build"
#: Pages of the repository beside those of `docs/`.
PAGES = ("CHANGELOG.md", "CONTRIBUTING.md", "tests/README.md", "docs/**/*.md", "studies/*/README.md")
#: Folders of the site that Sphinx reads as a copy.
FOLDERS = ("howto", "reference", "about", "static", "templates")
#: Folders whose files sphinx-gallery runs.
EXECUTED = ("gallery", "verification")
LINK = re.compile(r"\]\(([^)\s#:]+)(?:#[^)\s]*)?\)")
#: Pages of the site that the README leads to: their links hold in the repository, and are changed as they are copied.
READ_IN_PLACE = "howto"
EXAMPLE = re.compile(r"(\]\(\.\./gallery/[^)\s]+)\.py\)")


def pages_of_repository(root: Path = ROOT) -> list[Path]:
    """The pages that are shown as they are, sorted."""
    return sorted(path for pattern in PAGES for path in root.glob(pattern))


def linked_files(page: Path, folder: Path) -> set[Path]:
    """The files of the repository that a page in ``folder`` shows or links to, other pages among them."""
    targets = LINK.findall(page.read_text(encoding="utf-8"))
    files = {file for target in targets if (file := (folder / target).resolve()).is_file()}
    return {file for file in files if file.is_relative_to(ROOT)}


def as_copied(place: Path, file: Path) -> bytes:
    """A file as it lies in the source folder, where `docs` is beside `howto`, and examples are pages."""
    if place.parts[0] != READ_IN_PLACE or file.suffix != ".md":
        return file.read_bytes()
    return EXAMPLE.sub(r"\1.rst)", file.read_text(encoding="utf-8").replace("](../../", "](../")).encode()


def sources() -> dict[Path, Path]:
    """Every file of the site: place in the source folder -> file."""
    pages = pages_of_repository()
    # conf.py, the gallery and the verification book are read where they are.
    places = [SITE.glob("*.md"), *((SITE / name).rglob("*") for name in FOLDERS)]
    placed = {file.relative_to(SITE): file for files in places for file in files if file.is_file()}
    # A page of the site lies in the source folder as if this folder were the repository.
    linked = [
        linked_files(file, file.parent if place.parts[0] == READ_IN_PLACE else (ROOT / place).parent)
        for place, file in placed.items()
        if file.suffix == ".md"
    ]
    linked += [linked_files(page, page.parent) for page in pages]
    files = {*pages, *(file for each in linked for file in each if not file.is_relative_to(SITE))}
    return placed | {file.relative_to(ROOT): file for file in files}


def assemble(source: Path) -> None:
    """Copy what changed into the source folder, and remove what is gone. Files that Sphinx makes there stay."""
    record = source.parent / "copied.txt"
    before = set(record.read_text(encoding="utf-8").splitlines()) if record.is_file() else set()
    placed = sources()
    for place, file in placed.items():
        copy, content = source / place, as_copied(place, file)
        if not copy.is_file() or copy.read_bytes() != content:
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(content)
    for place in before - {place.as_posix() for place in placed}:
        (source / place).unlink(missing_ok=True)
    # What sphinx-gallery made of an example that has gone or moved.
    for name in EXECUTED:
        for example in (source / name).rglob("*.py"):
            if not (SITE / example.relative_to(source)).is_file():
                for made in example.parent.glob(f"{example.stem}.*"):
                    made.unlink()
    record.write_text("".join(f"{place.as_posix()}\n" for place in sorted(placed)), encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """Build the site, or check its links to other servers."""
    parser = argparse.ArgumentParser(description="Build the documentation as a site.")
    parser.add_argument("--no-run", action="store_true", help="show examples without running them")
    parser.add_argument("--links", action="store_true", help="only check links to other servers")
    parser.add_argument("--clean", action="store_true", help="forget earlier builds")
    given = parser.parse_args(arguments)
    try:
        from sphinx.cmd.build import build_main
    except ImportError:
        print("The site needs Sphinx: pip install -e '.[docs]'", file=sys.stderr)
        return 2
    if given.clean:
        shutil.rmtree(BUILD, ignore_errors=True)
    source = BUILD / "source"
    source.mkdir(parents=True, exist_ok=True)
    assemble(source)
    run = not (given.no_run or given.links)
    os.environ["TYREFEM_SITE_RESULTS"] = str(BUILD / "cases")
    builder = "linkcheck" if given.links else "html"
    # Examples run in this process: they find this checkout, whatever is installed.
    sys.path[:0] = [str(ROOT), str(SITE)]
    # A link to another server that does not answer is no error of Sphinx: `checked_servers` judges it.
    strict = [] if given.links else ["-W", "--keep-going"]
    flags = ["-b", builder, "-c", str(SITE), "-d", str(BUILD / "doctrees"), "-n", *strict, "-q"]
    flags += [] if run else ["-D", "plot_gallery=0"]
    if given.links:
        with contextlib.redirect_stderr(io.StringIO()):
            build_main([*flags, str(source), str(BUILD / builder)])
        return checked_servers()
    code = build_main([*flags, str(source), str(BUILD / builder)])
    return int(code) if code else checked_pages()


def checked_servers() -> int:
    """Print what other servers answered; 1 if a page is not there. A server that is not reached is no failure."""
    from links import answers_of_servers

    broken, unreachable, answered = answers_of_servers(BUILD / "linkcheck" / "output.json")
    for line in broken:
        print(f"broken link: {line}", file=sys.stderr)
    for line in unreachable:
        print(f"not reached: {line}", file=sys.stderr)
    print(f"Links to other servers: {answered} answer, {len(broken)} broken, {len(unreachable)} not reached.")
    return 1 if broken else 0


def checked_pages() -> int:
    """Print links inside the site that lead nowhere; 1 if there are any."""
    from links import dead_links

    dead = list(dead_links(BUILD / "html"))
    for line in dead:
        print(f"broken link: {line}", file=sys.stderr)
    if not dead:
        print(BUILD / "html" / "index.html")
    return 1 if dead else 0


if __name__ == "__main__":
    raise SystemExit(main())
