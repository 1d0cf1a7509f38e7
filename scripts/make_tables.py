#!/usr/bin/env python3
"""Writes the tables of docs/cli.md and docs/formats.md that repeat what the program and the schemas say.

usage: scripts/make_tables.py [PROGRAM]           build/release/bin/implicit-geodesic by default
       scripts/make_tables.py --check [PROGRAM]   change nothing; print what differs

A table is between two comments, `<!-- NAME: begin (made by scripts/make_tables.py) -->` and `<!-- NAME: end -->`:

  options of COMMAND   the options that PROGRAM --dump-options prints. The script writes their order, names, arguments,
                       choices and endings of files; units, defaults and meanings are those of the page. A new
                       option gets a row with the text of --help.
  files of results     the options that write a file, its endings and its name in a report
  fields of SCHEMA     the fields of docs/SCHEMA with their types and descriptions; of report.schema.json without
                       those that geodesics.schema.json has too

Exit code 1 if --check finds a difference, 2 if a table is unknown.
"""
import argparse
import difflib
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = ("docs/cli.md", "docs/formats.md")
MARKED = re.compile(r"(<!-- ([^:>]+): begin \(made by scripts/make_tables.py\) -->\n)(.*?)(<!-- \2: end -->)", re.DOTALL)


def row(*cells):
    return "| " + " | ".join(cells) + " |\n"


def code(words):
    return ", ".join(f"`{word}`" for word in words)


# ---- options ----

def cells_of(line):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def written_rows(table):
    """{"--levels": (["--levels", "--spacing"], value, default, meaning)} of a table, by each of its options."""
    rows = {}
    for line in table.splitlines():
        if line.startswith("| `-"):
            head, *others = cells_of(line)
            names = [words.split()[0] for words in re.findall(r"`(-[^`]*)`", head)]
            names = [name for name in names if name.startswith("--")]
            rows |= {name: (names, *others) for name in names}
    return rows


def head_of(option):
    value = " " + option["value"].replace("|", "\\|") if option["value"] else ""
    return ", ".join(f"`{name}{value if name == option['names'][-1] else ''}`" for name in option["names"])


def value_of(option, endings, written):
    """Choices and endings of files, and what the page adds to them."""
    by_hand = written.partition("; ")[2] if written.startswith("`") else written
    if option["choices"]:
        return "; ".join(filter(None, (code(option["choices"]), by_hand)))
    return ", ".join(endings.split()) or written


def options_table(command, program, table):
    of_main = [] if command is program else [
        (option["names"], option["value"], option["text"]) for option in program["options"]]
    own = [option for option in command["options"] if (option["names"], option["value"], option["text"]) not in of_main]
    endings = {result["option"]: result["endings"] for result in program["results"] if command is program}
    by_name, written = {option["names"][-1]: option for option in own}, written_rows(table)
    groups = {}
    for name, option in by_name.items():
        beside, value, default, meaning = written.get(name, ([name], "", "", option["text"].replace("|", "\\|") + "."))
        if beside[0] != name and beside[0] in by_name:
            continue  # two options that share a row
        head = ", ".join(head_of(by_name[other]) for other in beside if other in by_name)
        files = endings.get(option["names"][0], endings.get(name, ""))
        groups.setdefault(option["group"], []).append(row(head, value_of(option, files, value), default, meaning))
    text = row("option", "value, unit", "default", "meaning") + "|---|---|---|---|\n"
    for group, rows in groups.items():
        text += (row(f"**{group}**", "", "", "") if len(groups) > 1 and command is program else "") + "".join(rows)
    return text.replace("|  |", "| |").replace("|  |", "| |")


def results_table(program):
    text = row("option", "endings", "in a report") + "|---|---|---|\n"
    for result in program["results"]:
        text += row(f"`{result['option']}`", code(result["endings"].split()) or "any", f"`{result['name']}`")
    return text


# ---- fields ----

def type_of(field):
    if "$ref" in field:
        return field["$ref"].rpartition("/")[2]
    if "anyOf" in field:
        return " or ".join(type_of(one) for one in field["anyOf"])
    if "const" in field:
        return f"`{json.dumps(field['const'])}`".replace('"', "")
    if "enum" in field:
        return code(field["enum"])
    kinds = field["type"] if isinstance(field["type"], list) else [field["type"]]
    listed = "list of " + type_of(field["items"]) if "items" in field else "list"
    return " or ".join(listed if kind == "array" else kind for kind in kinds)


def fields_of(properties, before=""):
    """(name, type, description) of all fields, those of objects and lists of objects after them."""
    for name, field in properties.items():
        path = before + name
        yield path, type_of(field), field.get("description", "")
        if "properties" in field:
            yield from fields_of(field["properties"], path + ".")
        elif "properties" in field.get("items", {}):
            yield from fields_of(field["items"]["properties"], path + "[].")


def schema_fields(name):
    schema = json.loads((ROOT / "docs" / name).read_text(encoding="utf-8"))
    yield from fields_of(schema["properties"])
    for kind, definition in schema.get("$defs", {}).items():
        if "properties" in definition:
            yield kind, "object", definition.get("description", "")
            yield from fields_of(definition["properties"], kind + ".")
        else:
            yield kind, type_of(definition), definition.get("description", "")


def fields_table(name):
    known = set() if name == "geodesics.schema.json" else set(schema_fields("geodesics.schema.json"))
    text = row("field", "type", "meaning") + "|---|---|---|\n"
    for path, kind, meaning in schema_fields(name):
        if (path, kind, meaning) not in known:
            text += row(f"`{path}`", kind, meaning.replace("|", "\\|"))
    return text


# ---- pages ----

def made(page, program):
    """The text of a page with its tables made again."""
    commands = {}

    def enter(command, name):
        commands[name] = command
        for below in command["commands"]:
            enter(below, below["name"].partition(" ")[2])
    enter(program, "implicit-geodesic")

    def table_of(found):
        begin, name, table, end = found.groups()
        kind, _, what = name.partition(" of ")
        if kind == "options" and what in commands:
            return begin + options_table(commands[what], program, table) + end
        if name == "files of results":
            return begin + results_table(program) + end
        if kind == "fields" and (ROOT / "docs" / what).is_file():
            return begin + fields_table(what) + end
        sys.exit(f"make_tables.py: {page} has a table '{name}', which is unknown")
    text = (ROOT / page).read_text(encoding="utf-8")
    return text, MARKED.sub(table_of, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; print what differs")
    parser.add_argument("program", nargs="?", default=ROOT / "build/release/bin/implicit-geodesic", metavar="PROGRAM")
    options = parser.parse_args()
    dump = subprocess.run([options.program, "--dump-options"], check=True, capture_output=True, text=True)
    program, differ = json.loads(dump.stdout), False
    for page in PAGES:
        before, after = made(page, program)
        differ = differ or before != after
        if options.check:
            sys.stdout.writelines(difflib.unified_diff(before.splitlines(True), after.splitlines(True), page, "made again"))
        elif before != after:
            (ROOT / page).write_text(after, encoding="utf-8")
            print(f"wrote {page}")
    if options.check and differ:
        print("run scripts/make_tables.py")
    return 1 if options.check and differ else 0


if __name__ == "__main__":
    sys.exit(main())
