"""Files of a sweep: every table as CSV and Parquet, pictures, summary, page."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.brief import counted
from tyrefem.inputs.origin import StudyOrigin
from tyrefem.output import atomic_path, write_json
from tyrefem.reports.parquet import with_units, write_parquet
from tyrefem.reports.sweep import FILES as LIST
from tyrefem.reports.sweep import earlier, still_valid, write_page
from tyrefem.reports.sweep_variants import FOLDER as VARIANT_FILES
from tyrefem.sweep.question import sweep_questions
from tyrefem.sweep.responses import Responses
from tyrefem.sweep.sweep import ROWS_AT_ONCE, Sweep
from tyrefem.variants.store import NAME as VARIANTS

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.sweep.design import DesignData

PAGE = "sweep.html"


def part_names() -> tuple[str, ...]:
    """Names of the answers with tables, those of plugins too."""
    return ("sweep", "pareto", "indices", "optimum", *sweep_questions())


def file_names() -> tuple[str, ...]:
    """The files that a sweep may write into a folder, besides the study's: those of `save`, VTK files of variants."""
    return (*saved_names(), *(f"{VARIANT_FILES}/*/*.{kind}" for kind in ("pvd", "vtu", "py")))


def saved_names() -> tuple[str, ...]:
    """The files that `save` may write into a folder, besides the study's."""
    pictures = ("map-*.png", "curves-*.png", "bars-*.png", "pareto*.png", "indices-*.png", "optimum.png",
                *(f"{key}*.png" for key in sweep_questions()))  # fmt: skip
    return (
        *(f"{name}.{kind}" for name in part_names() for kind in ("csv", "parquet")),
        "errors.csv",
        PAGE,
        *(f"pictures/{name}" for name in pictures),
    )


def kept_names() -> tuple[str, ...]:
    """The files that keep finished variants."""
    return (VARIANTS, *(f"{name}/{VARIANTS}" for name in part_names()))


def save(design: DesignData, folder: Path, *, pictures: bool = True) -> dict[str, Any]:
    """Write ``NAME.csv`` and ``.parquet`` of every part, the study, ``summary.json`` and the page; return the summary.

    With a reduced model, also ``errors.csv``: the largest error of every answer in fresh full runs.
    Its ``files`` are those that stay in the folder; `results_folder` removes the others of an earlier question.
    """
    before, written = earlier(folder), []
    for part in design.parts:
        if isinstance(part, Responses) and len(part.swept.outcomes) > ROWS_AT_ONCE:
            written += write_parts(part.swept.parts(), folder, part.name)
        else:
            written += write_table(part.table, folder, part.name)
    if design.swept is not None and design.swept.certificate is not None:
        written += write_errors(design.swept, folder)
    written += StudyOrigin(design.study).write(folder)
    summary = summarised(design)
    if pictures:
        written += write_page(design, summary, folder)
    variants = [name for name in kept_names() if (folder / name).is_file()]
    summary[LIST] = [*written, *variants, *still_valid(folder, before, summary, written)]
    write_json(summary, folder / "summary.json")
    return summary


def write_table(table: pd.DataFrame, folder: Path, name: str) -> list[str]:
    """Write a table as CSV and as Parquet, there with units; return the names of the files."""
    with atomic_path(folder / f"{name}.csv") as temporary:
        table.to_csv(temporary, index=False, float_format="%.9g")
    write_parquet(table, folder / f"{name}.parquet")
    return [f"{name}.csv", f"{name}.parquet"]


def write_parts(parts: Iterator[pd.DataFrame], folder: Path, name: str) -> list[str]:
    """As `write_table`, for the parts of a long table one after the other: row groups of the Parquet file."""
    import pyarrow
    from pyarrow import parquet

    with (
        atomic_path(folder / f"{name}.csv") as text,
        atomic_path(folder / f"{name}.parquet") as binary,
        open(text, "w", encoding="utf-8", newline="") as lines,
        ExitStack() as opened,
    ):
        writer = schema = None
        for part in parts:
            part.to_csv(lines, index=False, float_format="%.9g", header=schema is None)
            content = pyarrow.Table.from_pandas(part, schema=schema, preserve_index=False)
            if writer is None:
                schema = with_units(_without_nulls(content.schema), part)
                writer = opened.enter_context(parquet.ParquetWriter(binary, schema))
            writer.write_table(content.cast(schema))
    return [f"{name}.csv", f"{name}.parquet"]


def _without_nulls(schema: Any) -> Any:
    """The schema of a table whose first part has columns without any value: they are texts."""
    import pyarrow

    fields = [field.with_type(pyarrow.string()) if pyarrow.types.is_null(field.type) else field for field in schema]
    return pyarrow.schema(fields, metadata=schema.metadata)


def write_errors(sweep: Sweep, folder: Path) -> list[str]:
    """Write the largest errors of the reduced model's answers in fresh full runs; return the name of the file."""
    import pandas as pd

    assert sweep.certificate is not None
    errors = pd.DataFrame({"answer": list(sweep.certificate.errors), "error": list(sweep.certificate.errors.values())})
    with atomic_path(folder / "errors.csv") as temporary:
        errors.to_csv(temporary, index=False, float_format="%.3g")
    return ["errors.csv"]


def summarised(design: DesignData) -> dict[str, Any]:
    """Contents of `summary.json`: sample, computation of the variants, every answer, versions, sentences."""
    study, card = design.study, design.card
    origin = StudyOrigin(study, simulated=True, random_seed=card.seed)
    made_of = origin.using(_variants(design), [part.name for part in design.parts]).summary()
    return made_of | {
        "title": card.title or study.title,
        "complete": not design.interrupted and (design.swept is None or design.swept.complete),
        "asked": card.model_dump(exclude_none=True, by_alias=True),
        **({} if design.swept is None else {"sample": sample_summary(design.swept)}),
        **{part.name: part.to_dict() for part in design.parts},
        "failures": design.failures,
        "versions": made_of["versions"] | {"SALib": importlib.metadata.version("SALib")},
        "words": text_lines(design),
    }


def _variants(design: DesignData) -> list[dict[str, Any]]:
    """Changes of variants with every value that is listed, and both ends of every range."""
    if design.swept is None:
        return []
    plan = design.swept.plan
    return [number.changes(value) for number in plan.varied for value in number.ends] or list(map(dict, plan.variants))


def sample_summary(sweep: Sweep) -> dict[str, Any]:
    """Numbers of variants of the sample, and the models that computed them."""
    certificate = sweep.certificate
    return {
        **sweep.plan.sampling,
        "variants": len(sweep.plan.variants),
        "finished": {
            "full": len(sweep.outcomes) - len(sweep.failed) - sweep.reduced,
            "reduced": sweep.reduced,
            "failed": len(sweep.failed),
        },
        "reduced_model": None
        if certificate is None
        else {
            "largest_error_K": certificate.error,
            "tolerance_K": certificate.tolerance,
            "fresh_cases": certificate.cases,
            "training_runs": certificate.trained_on - certificate.amended,
            "corrections": certificate.amended,
            "largest_errors": dict(certificate.errors),
        },
        "why_full_runs": sweep.why_full,
        "seconds": sweep.seconds,
        "taken_up": sweep.resumed,
    }


def text_lines(design: DesignData) -> list[str]:
    """Lines of text: title, computation of the variants, every answer under its heading."""
    lines = [design.card.title or design.study.title]
    if design.swept is not None:
        lines.append(f"  {computation_sentence(design.swept)}")
    for part in design.parts:
        if part.words:
            lines.append(f"{part.heading}:")
            lines += [f"  {line}" for line in part.words]
    return lines


def computation_sentence(sweep: Sweep) -> str:
    """Sentence on the number of variants, their computing time and their model."""
    certificate = sweep.certificate
    words = f"{len(sweep.outcomes)} of {len(sweep.plan.variants)} variants in {sweep.seconds:.1f} s"
    words += f", {sweep.resumed} of them reused" if sweep.resumed else ""
    if certificate is not None:
        words += (
            f"; {sweep.reduced} by a reduced model from {certificate.trained_on - certificate.amended} runs"
            f" and {counted(certificate.amended, 'correction')},"
            f" within {certificate.error:.2g} K of {certificate.cases} fresh full runs"
        )
    elif sweep.outcomes:
        words += "; all by full runs" + (f" ({sweep.why_full})" if sweep.why_full else "")
    return words
