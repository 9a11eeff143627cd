"""Reference pages of the rule books: every limit with clause, source and confirmation."""

from __future__ import annotations

from pathlib import Path

from surveyapp.core.tolerance.quantities import quantity
from surveyapp.domain.rulebook import Limit, RuleBook
from surveyapp.io.rulebooks import installed_rule_book_ids, read_rule_book

GENERATED = "*This page is generated from the rule books; do not edit it.*"


def pages() -> dict[str, str]:
    """Text of each page by its path below docs/."""
    books = [read_rule_book(name, base=Path()) for name in installed_rule_book_ids()]
    result = {f"reference/rule-books/{book.id}.md": page(book) for book in books}
    lines = ["# Rule books", "", GENERATED, ""]
    lines += [
        "A project names its rule book with `rule_book`. A limit that no source at hand confirms "
        "only warns. For limits of your own copy the TOML of a book into the project, edit it, and "
        "name its path.",
        "",
        "| book | title | limits | confirmed |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| [`{book.id}`]({book.id}.md) | {book.title} | {len(book.limits)} | "
        f"{sum(limit.confirmed for limit in book.limits)} |"
        for book in books
    ]
    result["reference/rule-books/index.md"] = "\n".join(lines) + "\n"
    return result


def page(book: RuleBook) -> str:
    """Text of one rule book's page."""
    lines = [f"# {book.title}", "", GENERATED, "", f"Rule book `{book.id}`. {book.source}.", ""]
    if book.note:
        lines += [book.note, ""]
    lines += ["| limit | what | class | bound | clause | confirmed |", "|---|---|---|---|---|---|"]
    lines += [row(limit) for limit in book.limits]
    lines += ["", "## Sources", ""]
    for source in dict.fromkeys(limit.source for limit in book.limits):
        ids = ", ".join(f"`{limit.id}`" for limit in book.limits if limit.source == source)
        lines.append(f"- {source}: {ids}")
    return "\n".join(lines) + "\n"


def row(limit: Limit) -> str:
    """One limit as a row of the table."""
    bound = limit.limit if isinstance(limit.limit, str) else f"{limit.limit:g}"
    bound = f"1 in {bound}" if limit.unit == "1 in" else f"{bound} {limit.unit}"
    words = f"{limit.sense} {bound}" + (f" where {limit.when}" if limit.when else "")
    what = quantity(limit.quantity).title + (f" ({limit.note})" if limit.note else "")
    confirmed = "yes" if limit.confirmed else "no"
    class_name = limit.class_name or "all"
    cells = (f"`{limit.id}`", what, class_name, words, limit.clause, confirmed)
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"
