#!/usr/bin/env python3
"""Makes the manual page and the completions of implicit-geodesic from its options.

usage: scripts/make_pages.py PROGRAM FOLDER

Writes in FOLDER: man/man1/implicit-geodesic.1, and completions for bash, zsh and fish. The build
runs it; the options are those that PROGRAM --dump-options prints as JSON.
"""
import json
import pathlib
import re
import subprocess
import sys

NAME = "implicit-geodesic"


def flattened(command):
    """{"": the program, "info": its command, "batch": ..., "batch merge": ...}."""
    commands = {command["name"][len(NAME) + 1:]: command}
    for below in command["commands"]:
        commands.update(flattened(below))
    return commands


def last_word(command):
    return command["name"].split()[-1]


# The manual page

def roff(text):
    """Text that troff prints as it is: all dashes are those of options and numbers."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("~", "\\(ti").replace("^", "\\(ha")
    return "\\&" + text if text[:1] in (".", "'") else text


def man_text(option):
    text = option["text"] + "."
    if option["range"]:
        text += f" Allowed: {option['range']}."
    if option["repeatable"] and not option["separator"] and "repeat" not in option["text"]:
        text += " May be repeated."
    if option["excludes"]:
        text += f" Not with {', '.join(option['excludes'])}."
    return roff(text)


def man_options(command):
    lines, group = [], None
    for option in sorted(command["options"], key=lambda o: groups_of(command).index(o["group"])):
        if option["group"] != group:
            group = option["group"]
            lines.append(f".SS {roff(group)}")
        head = ", ".join(f"\\fB{roff(name)}\\fR" for name in option["names"])
        if option["value"]:
            head += f" \\fI{roff(option['value'])}\\fR"
        lines += [".TP", head, man_text(option)]
    return lines


def groups_of(command):
    return list(dict.fromkeys(option["group"] for option in command["options"]))


def man_exit_codes(command):
    return [line for code in command["exit_codes"]
            for line in (".TP", f"\\fB{code['code']}\\fR", roff(code["meaning"]))]


def man_examples(command):
    lines = []
    for example in command["examples"]:
        lines += [".PP"] if lines else []
        lines += [roff(example["meaning"]) + ":", ".PP", ".nf", ".RS", roff(example["command"]),
                  ".RE", ".fi"]
    return lines


def man_synopsis(command):
    arguments = "".join(f" \\fI{roff(argument['names'][0] + argument['value'])}\\fR"
                        + (" ..." if argument["repeatable"] else "")
                        for argument in command["arguments"])
    return f"\\fB{roff(command['name'])}\\fR{arguments} [\\fIoptions\\fR]"


def man_arguments(command):
    return [line for argument in command["arguments"]
            for line in (".TP", f"\\fI{roff(argument['names'][0] + argument['value'])}\\fR", man_text(argument))]


def man_command(title, command):
    """A section of its own for a subcommand."""
    lines = [f".SH {roff(title.upper())}", man_synopsis(command), ".PP", roff(command["about"] + ".")]
    return [*lines, *man_arguments(command), *man_options(command), ".SS Exit status", *man_exit_codes(command),
            ".SS Examples", *man_examples(command)]


def man_page(commands):
    program = commands[""]
    below = {title: command for title, command in commands.items() if title}
    lines = [f'.TH {NAME.upper()} 1 "" "{NAME} {program["version"]}" "User Commands"',
             ".SH NAME",
             f"{roff(NAME)} \\- distances and shortest paths along a surface held as a level set",
             ".SH SYNOPSIS", "\n.br\n".join(map(man_synopsis, commands.values())),
             ".SH DESCRIPTION", *map(roff, program["about"].splitlines()),
             ".SH OPTIONS", *man_arguments(program), *man_options(program)]
    for title, command in below.items():
        lines += man_command(title, command)
    lines += [".SH EXIT STATUS", *man_exit_codes(program),
              ".SH EXAMPLES", *man_examples(program),
              ".SH SEE ALSO", ".BR vdb_tool (1),", ".BR vdb_print (1),", ".BR vdb_view (1),",
              ".BR vdb_render (1)"]
    return "\n".join(lines) + "\n"


# Completions

def endings(option):
    """Of the files that an option or argument takes: ["vdb"], ["*"] for any, nothing if it takes none."""
    value = option["value"]
    if option["names"][0].startswith("-") and not value.startswith("FILE"):
        return []
    if value.endswith(("[:GRID]", "[:PREFIX]")) and option["names"][0].startswith("-"):
        return ["vdb"]
    named = re.fullmatch(r"FILE\.(\w+)", value)
    if named:
        return [named[1]]
    said = re.findall(r"(?<!\S)\.([\w.]*\w)", option["text"])  # .func.gii ends in gii
    return list(dict.fromkeys(ending.split(".")[-1] for ending in said)) or ["*"]


BASH = r"""# Completion of implicit-geodesic in bash, made from its options.
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


def bash_cases(command):
    """Lines of a case over the option before the cursor."""
    cases = [":) return ;;  # a grid in a file"]
    unknown = []
    for option in command["options"]:
        if not option["value"]:
            continue
        pattern = " | ".join(option["names"])
        if option["choices"]:
            several = " several=yes" if option["separator"] else ""
            cases.append(f"{pattern}) values='{' '.join(option['choices'])}'{several} ;;")
        elif endings(option):
            files = " ".join(endings(option)).replace("*", "any")
            cases.append(f"{pattern}) files='{files}' ;;")
        else:
            unknown += option["names"]
    if unknown:
        cases.append(f"{' | '.join(unknown)}) return ;;  # numbers and names")
    return "\n".join(" " * 8 + case for case in cases)


def names_of(command):
    return " ".join(name for option in command["options"] for name in option["names"])


def bash_command(title, command):
    """The same for a subcommand, whose words without a dash are files, or subcommands first."""
    files = " ".join(e for argument in command["arguments"] for e in endings(argument))
    inner = " ".join(map(last_word, command["commands"]))
    more = f"""
        if [[ ${{#words[@]}} == 1 && -n $current && " {inner}" == " $current"* ]]; then
            options+=' {inner}' files=''
        fi""" if inner else ""
    return f"""    " {title} "*)
        options='{names_of(command)}'
        case $option in
{bash_cases(command)}
        esac
        if [[ -z $values && $current != -* ]]; then
            files=${{files:-{files.replace("*", "any")}}}
        fi{more}
        ;;"""


def filled(text, parts):
    for mark, part in parts.items():
        text = text.replace(mark, part)
    return text


def longest_first(commands):
    """Subcommands; "batch merge" before "batch"."""
    return sorted(filter(None, commands), reverse=True)


def bash_completion(commands):
    return filled(BASH, {
        "@CASES@": bash_cases(commands[""]),
        "@OPTIONS@": names_of(commands[""]),
        "@COMMANDS@": " ".join(map(last_word, commands[""]["commands"])),
        "@SUBCOMMANDS@": "\n".join(bash_command(title, commands[title])
                                   for title in longest_first(commands))})


ZSH = r"""#compdef implicit-geodesic
# Completion of implicit-geodesic in zsh, made from its options.
_implicit-geodesic() {
    local -a commands
    case "${(j: :)words[2,CURRENT-1]} " in
@CASES@
    esac
}
_implicit-geodesic "$@"
"""


def zsh_quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_action(option):
    if option["choices"]:
        choices = " ".join(option["choices"])
        return f"_values -s , value {choices}" if option["separator"] else f"({choices})"
    files = endings(option)
    if not files:
        return " "
    # *.(vdb) would be a pattern with qualifiers.
    pattern = f"({'|'.join(files)})" if len(files) > 1 else files[0]
    return "_files" if pattern == "*" else f'_files -g "*.{pattern}"'


def zsh_specs(option):
    """Of _arguments: '(--band)--band-voxels=[The same in voxels]:N: '."""
    repeated = option["repeatable"] and not option["separator"]
    excluded = option["excludes"] + ([] if repeated else option["names"])
    text = re.sub(r"([\[\]\\])", r"\\\1", option["text"])
    value = f":{option['value'].replace(':', chr(92) + ':')}:{zsh_action(option)}" if option["value"] else ""
    for name in option["names"]:
        takes = "" if not value else "=" if name.startswith("--") else "+"
        yield f"({' '.join(excluded)})" + "*" * repeated + f"{name}{takes}[{text}]{value}"


def zsh_positionals(command):
    inner = "_describe command commands" if command["commands"] else ""
    for argument in command["arguments"]:
        place = "*" if argument["repeatable"] else "1"
        if inner:
            yield f"{place}: :{{{inner}; {zsh_action(argument)}}}"
        else:
            yield f"{place}:{argument['names'][0]}:{zsh_action(argument)}"
    if inner and not command["arguments"]:
        yield f"1: :{{{inner}}}"


def zsh_case(title, command):
    described = " ".join(zsh_quoted(f"{last_word(c)}:{c['about']}") for c in command["commands"])
    specs = [*(spec for option in command["options"] for spec in zsh_specs(option)),
             *zsh_positionals(command)]
    lines = [zsh_quoted(title + " ") + "*)" if title else "*)", f"    commands=({described})"]
    if title:  # its last word is in the place of the program
        lines += [f"    shift {len(title.split())} words", f"    (( CURRENT -= {len(title.split())} ))"]
    lines += ["    _arguments -s \\", " \\\n".join(" " * 12 + zsh_quoted(spec) for spec in specs), "    ;;"]
    return "\n".join(line if line.startswith(" " * 12) else "    " + line for line in lines)


def zsh_completion(commands):
    return filled(ZSH, {"@CASES@": "\n".join(zsh_case(title, commands[title])
                                             for title in [*longest_first(commands), ""])})


FISH = r"""# Completion of implicit-geodesic in fish, made from its options.
function __implicit_geodesic_words
    set -l words (commandline -opc)
    echo (string join ' ' -- $words[2..-1])
end

# Whether the words before the cursor are those of a subcommand, and no more.
function __implicit_geodesic_at
    test (__implicit_geodesic_words) = "$argv"
end

# Whether they begin with it.
function __implicit_geodesic_in
    set -l command ''
    switch (__implicit_geodesic_words)' '
@CASES@
    end
    test "$command" = "$argv"
end

# Folders, and files with one of these endings.
function __implicit_geodesic_files
    set -l word (string replace -r '^--[^=]*=' '' -- (commandline -ct))
    __fish_complete_path $word | string match -er '(?:/|\.(?:'(string join '|' -- $argv)'))(?:\t|$)'
end

complete -c implicit-geodesic -f
@COMPLETE@
"""


def fish_quoted(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish_values(option):
    """Of `complete`: what an option or argument takes."""
    files = endings(option)
    if option["separator"]:
        values = f"(__fish_complete_list , 'printf \"%s\\n\" {' '.join(option['choices'])}')"
    elif option["choices"]:
        values = " ".join(option["choices"])
    elif files and files != ["*"]:
        values = f"(__implicit_geodesic_files {' '.join(files)})"
    else:
        return "-r -F" if files else "-x"
    return f"-x -a {fish_quoted(values)}"


def fish_lines(title, command):
    start = f"complete -c {NAME} -n {fish_quoted(f'__implicit_geodesic_in {title}'.strip())}"
    for option in command["options"]:
        names = " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
                         for name in option["names"])
        values = f" {fish_values(option)}" if option["value"] else ""
        yield f"{start} {names}{values} -d {fish_quoted(option['text'])}"
    for argument in command["arguments"]:
        yield f"{start} {fish_values(argument)}".replace(" -x ", " ").replace(" -r ", " ")
    for below in command["commands"]:
        yield (f"{start.replace('_in', '_at')} -a {last_word(below)} -d {fish_quoted(below['about'])}")


def fish_completion(commands):
    cases = [f"        case '{title} *'\n            set command '{title}'" for title in longest_first(commands)]
    return filled(FISH, {"@CASES@": "\n".join(cases),
                         "@COMPLETE@": "\n".join(line for title, command in commands.items()
                                                 for line in fish_lines(title, command))})


def main(program, folder):
    dump = subprocess.run([program, "--dump-options"], check=True, capture_output=True, text=True)
    commands = flattened(json.loads(dump.stdout))
    pages = {f"man/man1/{NAME}.1": man_page,
             f"bash-completion/completions/{NAME}": bash_completion,
             f"zsh/site-functions/_{NAME}": zsh_completion,
             f"fish/vendor_completions.d/{NAME}.fish": fish_completion}
    for file, text in {file: make(commands) for file, make in pages.items()}.items():
        path = pathlib.Path(folder) / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
