#!/usr/bin/env python3
"""Makes the manual page and the bash completion of implicit-geodesic from what its --help says.

usage: scripts/make_pages.py PROGRAM FOLDER

Writes man/man1/implicit-geodesic.1 and bash-completion/completions/implicit-geodesic in FOLDER. The
build runs it, so that neither can differ from the help.
"""
import dataclasses
import pathlib
import re
import subprocess
import sys

NAME = "implicit-geodesic"


@dataclasses.dataclass
class Option:
    names: list  # as spelled: -o, --output
    argument: str = ""  # as the help names it; empty for a flag
    choices: list = dataclasses.field(default_factory=list)
    bounds: tuple = ()  # least, largest
    repeatable: bool = False
    required: bool = False
    needs: list = dataclasses.field(default_factory=list)
    excludes: list = dataclasses.field(default_factory=list)
    text: str = ""


@dataclasses.dataclass
class Help:
    about: list = dataclasses.field(default_factory=list)  # lines
    groups: dict = dataclasses.field(default_factory=dict)  # title -> options
    arguments: list = dataclasses.field(default_factory=list)  # (name, meaning), without a dash
    commands: list = dataclasses.field(default_factory=list)  # (name, meaning)
    exit_codes: list = dataclasses.field(default_factory=list)  # (code, meaning)
    examples: list = dataclasses.field(default_factory=list)  # (command, what it does)

    def options(self):
        return [option for group in self.groups.values() for option in group]


def parse_option(head):
    """From what stands left in a line of the help, such as
    --levels N:INT in [1 - 100000] Excludes: --spacing."""
    head, _, excludes = head.partition(" Excludes: ")
    head, _, needs = head.partition(" Needs: ")
    names, _, rest = head.partition(" ")
    option = Option(names.split(","), needs=needs.split(), excludes=excludes.split())
    for word, field in ((" REQUIRED", "required"), (" ...", "repeatable")):
        if rest.endswith(word):
            rest = rest[:-len(word)]
            setattr(option, field, True)
    chosen = re.fullmatch(r"(.*):\{(.*)\}", rest)
    bounded = re.fullmatch(r"(.*):[A-Z]+ in \[(\S+) - (\S+)\]", rest)
    if chosen:
        rest, option.choices = chosen[1], chosen[2].split(",")
    elif bounded:
        rest, option.bounds = bounded[1], (bounded[2], bounded[3])
    else:
        # avoid|prefer[,length=L]
        listed = rest.partition("[")[0].split("|")
        if len(listed) > 1:
            option.choices = listed
    option.argument = rest
    return option


def parse_help(text):
    """The help as CLI11 prints it, with the footer of options.cpp."""
    body, _, footer = text.partition("\nExit codes: ")
    page = Help()
    option = group = words = None
    for line in body.splitlines():
        if line.startswith("Usage:") or not line.strip():
            continue
        if line.startswith("  -"):
            head, *rest = re.split(r" {2,}", line.strip(), maxsplit=1)
            option = parse_option(head)
            option.text = "".join(rest)
            group.append(option)
        elif words is not None and re.match(r"  \S", line):
            name, meaning = re.split(r" {2,}", line.strip(), maxsplit=1)
            words.append((name.replace(" REQUIRED", "").replace(" ", ""), meaning))
        elif line.startswith(" "):
            option.text = (option.text + " " + line.strip()).strip()
        elif line in ("Positionals:", "Subcommands:"):
            words = page.arguments if line.startswith("P") else page.commands
        elif line.endswith(":"):
            words = None
            group = page.groups.setdefault(line[:-1], [])
        elif group is None:
            page.about.append(line)
        else:
            raise ValueError(f"make_pages.py: does not understand this line of the help: {line!r}")
    codes, _, examples = footer.partition("\nExamples:\n")
    page.exit_codes = re.findall(r"(\d+) ([^,\d.]+)", codes.replace("\n", " "))
    page.examples = re.findall(r"^  (\S.*)\n {6}(\S.*)$", examples + "\n", re.MULTILINE)
    if not (page.about and page.groups and page.exit_codes and page.examples):
        raise ValueError("make_pages.py: the help lacks a part")
    return page


def roff(text):
    """Text that troff prints as it is: all dashes are those of options and numbers."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("~", "\\(ti").replace("^", "\\(ha")
    return "\\&" + text if text[:1] in (".", "'") else text


def man_options(page):
    lines = []
    for title, options in page.groups.items():
        lines.append(f".SS {roff(title)}")
        for option in options:
            head = ", ".join(f"\\fB{roff(n)}\\fR" for n in option.names)
            if option.argument:
                head += f" \\fI{roff(option.argument)}\\fR"
            text = option.text + "."
            if option.bounds:
                text += " From {} to {}.".format(*option.bounds)
            if option.repeatable and "repeat" not in option.text:
                text += " May be repeated."
            if option.required:
                text += " Required."
            if option.needs:
                text += f" Needs {', '.join(option.needs)}."
            if option.excludes:
                text += f" Not together with {', '.join(option.excludes)}."
            lines += [".TP", head, roff(text)]
    return lines


def man_exit_codes(page):
    lines = []
    for code, meaning in page.exit_codes:
        lines += [".TP", f"\\fB{code}\\fR", roff(meaning.strip())]
    return lines


def man_examples(page):
    lines = []
    for number, (command, meaning) in enumerate(page.examples):
        lines += [".PP"] if number else []
        lines += [roff(meaning) + ":", ".PP", ".nf", ".RS", roff(command), ".RE", ".fi"]
    return lines


def man_command(name, page):
    """A section of its own for a subcommand."""
    arguments = "".join(f" \\fI{roff(word)}\\fR" for word, _ in page.arguments)
    lines = [f".SH {roff(name.upper())}",
             f"\\fB{roff(NAME)} {roff(name)}\\fR{arguments} [\\fIoptions\\fR]", ".PP",
             *(roff(line + ".") for line in page.about)]
    for word, meaning in page.arguments:
        lines += [".TP", f"\\fI{roff(word)}\\fR", roff(meaning + ".")]
    return [*lines, *man_options(page), ".SS Exit status", *man_exit_codes(page),
            ".SS Examples", *man_examples(page)]


def man_page(page, commands, version):
    synopsis = "".join(f" \\fB{roff(o.names[-1])}\\fR \\fI{roff(o.argument)}\\fR"
                       for o in page.options() if o.required)
    lines = [f'.TH {NAME.upper()} 1 "" "{version}" "User Commands"',
             ".SH NAME",
             f"{roff(NAME)} \\- distances and shortest paths along a surface held as a level set",
             ".SH SYNOPSIS", f"\\fB{roff(NAME)}\\fR{synopsis} [\\fIoptions\\fR]",
             *(line for name in commands
               for line in (".br", f"\\fB{roff(NAME)} {roff(name)}\\fR \\fI...\\fR")),
             ".SH DESCRIPTION", *map(roff, page.about),
             ".SH OPTIONS", *man_options(page)]
    for name, command in commands.items():
        lines += man_command(name, command)
    lines += [".SH EXIT STATUS", *man_exit_codes(page)]
    lines += [".SH ENVIRONMENT", ".TP", "\\fBNO_COLOR\\fR",
              "If set, no progress is shown unless asked for.", ".SH EXAMPLES"]
    lines += man_examples(page)
    lines += [".SH SEE ALSO", ".BR vdb_tool (1),", ".BR vdb_print (1),", ".BR vdb_view (1),",
              ".BR vdb_render (1)"]
    return "\n".join(lines) + "\n"


def endings_of(argument, text):
    """Of the files that an argument takes: ["vdb"], ["*"] for any."""
    if argument.endswith("[:GRID]") or argument.endswith("[:PREFIX]"):
        return ["vdb"]
    named = re.fullmatch(r"FILE\.(\w+)", argument)
    return [named[1]] if named else re.findall(r"(?<!\S)\.(\w+)", text) or ["*"]


def endings(option):
    """The same of an option; nothing if it takes no file."""
    return endings_of(option.argument, option.text) if option.argument.startswith("FILE") else []


COMPLETION = r"""# Completion of implicit-geodesic in bash, made from its --help.
_implicit_geodesic() {
    local current=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]}
    local files='' values='' several='' ending first
    local options='@OPTIONS@'
    COMPREPLY=()
    # bash splits --option=value into three words.
    if [[ $current == = ]]; then
        current=''
    elif [[ $option == = ]]; then
        option=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    # Words of a subcommand that are complete.
    local words=("${COMP_WORDS[@]:1:COMP_CWORD - 1}")
    if [[ ${#words[@]} == 0 ]]; then
        options+=' @COMMANDS@'
    fi
    case " ${words[0]-} ${words[1]-} " in
@SUBCOMMANDS@
    *)
        case $option in
@CASES@
        esac
        ;;
    esac
    if [[ -n $files ]]; then
        compopt -o filenames 2>/dev/null
        if [[ $files == any ]]; then
            mapfile -t COMPREPLY < <(compgen -f -- "$current")
        else
            mapfile -t COMPREPLY < <(
                compgen -d -- "$current"
                for ending in $files; do compgen -f -X "!*.$ending" -- "$current"; done)
        fi
    elif [[ -n $several ]]; then
        first=${current%"${current##*,}"}
        compopt -o nospace 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -P "$first" -W "$values" -- "${current##*,}")
    else
        mapfile -t COMPREPLY < <(compgen -W "${values:-$options}" -- "$current")
    fi
}
complete -F _implicit_geodesic implicit-geodesic
"""


def completion_cases(page):
    """Lines of a case over the option before the cursor."""
    cases = [":) return ;;  # a grid in a file"]
    unknown = []
    for option in page.options():
        if not option.argument:
            continue
        pattern = " | ".join(option.names)
        if option.choices:
            several = " several=yes" if option.argument == "LIST" else ""
            cases.append(f"{pattern}) values='{' '.join(option.choices)}'{several} ;;")
        elif endings(option):
            files = " ".join(endings(option)).replace("*", "any")
            cases.append(f"{pattern}) files='{files}' ;;")
        else:
            unknown += option.names
    if unknown:
        cases.append(f"{' | '.join(unknown)}) return ;;  # numbers and names")
    return "\n".join(" " * 8 + case for case in cases)


def completion_command(name, page):
    """The same for a subcommand, whose words without a dash are files, or subcommands first."""
    names = " ".join(n for option in page.options() for n in option.names)
    files = " ".join(e for word, meaning in page.arguments for e in endings_of(word, meaning))
    inner = " ".join(command for command, _ in page.commands)
    more = f"""
        if [[ ${{#words[@]}} == 1 && -n $current && " {inner}" == " $current"* ]]; then
            options+=' {inner}' files=''
        fi""" if inner else ""
    return f"""    " {name} "*)
        options='{names}'
        case $option in
{completion_cases(page)}
        esac
        if [[ -z $values && $current != -* ]]; then
            files=${{files:-{files.replace("*", "any")}}}
        fi{more}
        ;;"""


def completion(page, commands):
    parts = {"@CASES@": completion_cases(page),
             "@OPTIONS@": " ".join(n for option in page.options() for n in option.names),
             "@COMMANDS@": " ".join(name for name, _ in page.commands),
             # Longer names first: "batch merge" before "batch".
             "@SUBCOMMANDS@": "\n".join(completion_command(name, commands[name])
                                        for name in sorted(commands, reverse=True))}
    text = COMPLETION
    for mark, part in parts.items():
        text = text.replace(mark, part)
    return text


def main(program, folder):
    def says(*words):
        return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout

    def commands_of(page, *before):
        """Also those of subcommands: {"info": Help, "batch": Help, "batch merge": Help}."""
        all_commands = {}
        for name, _ in page.commands:
            words = (*before, name)
            command = parse_help(says(*words, "--help"))
            all_commands[" ".join(words)] = command
            all_commands.update(commands_of(command, *words))
        return all_commands

    page = parse_help(says("--help"))
    commands = commands_of(page)
    version = says("--version").strip()
    for file, text in ((f"man/man1/{NAME}.1", man_page(page, commands, version)),
                       (f"bash-completion/completions/{NAME}", completion(page, commands))):
        path = pathlib.Path(folder) / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
