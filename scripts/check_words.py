#!/usr/bin/env python3
"""Finds words that the pages, messages and comments do without, and names better ones.

usage: scripts/check_words.py [PATH...]   files and folders; by default the project
       scripts/check_words.py --list      the words

It reads the text of pages without their code, the comments and strings of C++, JavaScript, Python, shell and CMake,
and the strings of JSON.
For each finding it prints `FILE:LINE: words: better words`. Exit code 1 if there is a finding, 2 if a
path cannot be read.

The rule: the subject is the thing that acts, one idea per sentence, the field's noun, positive form,
American spelling.
"""
import argparse
import io
import pathlib
import re
import sys
import tokenize

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROJECT = ("README.md", "CMakeLists.txt", "src", "apps", "docs", "data", "tests", "scripts")
# They have the words to find as words to find.
ABOUT_WORDS = (pathlib.Path(__file__).resolve(), ROOT / "tests/docs/test_check_words.py")

BRITISH_IZE = ("amortise|analogise|apologise|authorise|capitalise|categorise|centralise|characterise|criticise|crystallise"
               "|customise|discretise|diagonalise|emphasise|equalise|factorise|familiarise|finalise|formalise|generalise"
               "|harmonise|initialise|linearise|localise|maximise|memorise|minimise|modernise|neutralise|normalise"
               "|optimise|organise|parallelise|parameterise|parametrise|penalise|polarise|prioritise|quantise|randomise"
               "|rasterise|realise|recognise|regularise|reorganise|serialise|specialise|stabilise|standardise"
               "|summarise|symbolise|symmetrise|synchronise|tokenise|triangularise|utilise|vectorise|visualise|voxelise")

# What to find (whole words in any case; a blank is any white space), and what to write instead.
WORDS = {
    "ways?": "path, cost, vector, direction or method",
    "(held|hold|holds|holding) ((it|them|this|that|these|those|each|all) )?against": "compare with, check by",
    "told": "reported, distinguished",
    "(warning|line|message|report|run|program|file|page|column|text)s? tells?": "report, print",
    "dear(er|est)?": "expensive",
    "nobody": "no user, nothing",
    "who(so)?ever|whomever": "a user who, the X that",
    "rooms?": "clearance, memory, space; layer, module",
    "counts? for nothing|counted for nothing": "has no effect",
    "plays? no part|played no part": "has no effect",
    "(will|would|won't) (it |they )?do(?=[,.;:?!]| for )": "is usable",
    "stands?(?! (for|alone|out)\\b)|stood": "is, is written",
    "manners?": "conventions, manner: like",
    "mend(s|ed|ing)?": "fix",
    "doubtful": "unreliable",
    "ma(ke|kes|de|king) up for": "compensate",
    "now and then": "sometimes",
    "once more": "again",
    "want of": "lack of, without",
    "for ever": "forever",
    "to the letter": "exactly",
    "hand(s|ed|ing) (on|over)": "pass to",
    "giv(es?|en|ing) back|gave back": "free, return",
    "as (it|they) (is|are) there": "as in the file",
    "nic(e|er|est|ely)": "say in which property it is better",
    "stumbles?( over)?|shuns?": "fail on, avoid",
    "anew": "again",
    "so to speak|as it were|by the way|needless to say": "leave it out",
    "in a sentence|without a word": "with a message, without a message",
    "(knows?|knew) better": "say what is known",
    "alas|lest|ere|naught|nought|betwixt|whence|thence|thither|thereof|whereof|albeit|amidst|upon|heretofore":
        "a plain word",
    "(dis|re)?colour(s|ed|ing|less|ful)?": "color",
    "grey(s|ish|scale)?": "gray",
    r"neighbour\w*": "neighbor",
    r"behaviour\w*": "behavior",
    "(centre|metre|centimetre|millimetre|kilometre|litre|fibre)[sd]?": "center, meter, liter, fiber",
    r"(favour|honour|labour|vapour|flavour|rigour)\w*": "favor, honor, labor, vapor, flavor, rigor",
    "(licence|defence|offence)s?": "license, defense, offense",
    "(%s)([sdr]|rs)?" % BRITISH_IZE: "-ize",
    "(%s)(ing|ations?)" % BRITISH_IZE.replace("e|", "|").removesuffix("e"): "-izing, -ization",
    "(analyse|catalyse|paralyse)[dr]?|(analys|catalys|paralys)ing": "analyze, catalyze, paralyze",
    "(label|model|travel|signal|channel|tunnel|level|fuel)l(ed|ing)": "one l",
    "artefacts?": "artifact",
    "whilst|amongst": "while, among",
    "programmes?": "program",
    "fulfils?|skilful|wilful": "fulfill, skillful, willful",
    "judgements?": "judgment",
    "learnt|spelt|burnt": "learned, spelled, burned",
    "maths|aluminium|sulphur": "math, aluminum, sulfur",
    "catalogues?|analogues?|dialogues?": "catalog, analog, dialog",
}

# Idioms in which the words above mean what they say.
PLAIN = ("(either|other|another|one|two|this|that|which|whichever|what|same|different|opposite)[- ]ways?",
         "in (its|their) own way")


def whole(pattern):
    """A pattern for whole words; blanks of it match any white space."""
    blanks = pattern.replace(" ", r"\s+")
    return re.compile(rf"(?<![\w-])(?:{blanks})(?![\w-])", re.IGNORECASE)


FIND = [(whole(pattern), better) for pattern, better in WORDS.items()]
KEEP = [whole(pattern) for pattern in PLAIN]


def blank(text):
    """As many characters without words, with the same line breaks."""
    return re.sub(r"[^\n]", "\0", text)


def only(text, spans):
    """The text with all but these spans blank, and without the marks of comments."""
    out, end = [], 0
    for begin, stop in spans:
        words = re.sub(r"//[/!]?<?|#", lambda mark: " " * len(mark[0]), text[begin:stop])
        out += [blank(text[end:begin]).replace("\0", " "), words]
        end = stop
    return "".join(out) + blank(text[end:])


def page_text(text):
    """Markdown without code, comments and addresses of links."""
    code = r"^```.*?^```|<!--.*?-->|`[^`]{1,300}`|\]\([^)\s]*\)|https?://\S+"
    return re.sub(code, lambda found: blank(found[0]), text, flags=re.DOTALL | re.MULTILINE)


def cpp_text(text):
    """Comments and strings of C++, without code quoted in comments."""
    parts = r'//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''
    text = only(text, [found.span() for found in re.finditer(parts, text, re.DOTALL)])
    return re.sub(r"`[^`\n]*`", lambda found: blank(found[0]), text)


def python_text(text):
    """Comments and strings of Python."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    kinds = {tokenize.COMMENT, tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)}
    return only(text, [(starts[token.start[0] - 1] + token.start[1], starts[token.end[0] - 1] + token.end[1])
                       for token in tokenize.generate_tokens(io.StringIO(text).readline) if token.type in kinds])


def shell_text(text):
    """Comments and strings of shell and CMake."""
    return only(text, [found.span() for found in re.finditer(r'(?<!\S)#[^\n]*|"(?:\\.|[^"\\])*"', text)])


def html_text(text):
    """HTML without its tags."""
    return re.sub(r"<[^>]*>", lambda found: blank(found[0]), text)


def json_text(text):
    """Strings of JSON."""
    return only(text, [found.span() for found in re.finditer(r'"(?:[^"\\]|\\.)*"', text)])


READERS = {".md": page_text, ".h": cpp_text, ".cpp": cpp_text, ".in": cpp_text, ".py": python_text,
           ".sh": shell_text, ".cmake": shell_text, "CMakeLists.txt": shell_text, ".js": cpp_text, ".html": html_text,
           ".json": json_text}


def kind_of(file):
    """A key of READERS, if there is one."""
    return file.name if file.name in READERS else file.suffix


def findings(text, suffix):
    """(line number, words, better words) of a text, in its order."""
    text = READERS[suffix](text)
    plain = [found.span() for pattern in KEEP for found in pattern.finditer(text)]
    found = [(match.start(), " ".join(match[0].split()), better)
             for pattern, better in FIND for match in pattern.finditer(text)
             if not any(begin <= match.start() and match.end() <= end for begin, end in plain)]
    return [(text.count("\n", 0, start) + 1, words, better) for start, words, better in sorted(found)]


def files_of(paths):
    """The files that are named, and those in the folders that are named."""
    for path in paths:
        if path.is_file():
            yield path
        else:
            yield from sorted(file for file in path.rglob("*") if kind_of(file) in READERS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", type=pathlib.Path, metavar="PATH")
    parser.add_argument("--list", action="store_true", help="print the words and what to write instead")
    options = parser.parse_args()
    if options.list:
        print("\n".join(f"{pattern}: {better}" for pattern, better in WORDS.items()))
        return 0
    missing = [path for path in options.paths if not path.exists()]
    if missing:
        print(f"check_words.py: {missing[0]} is not there", file=sys.stderr)
        return 2
    paths = list(files_of(options.paths or [ROOT / name for name in PROJECT]))
    count = 0
    for file in paths:
        if file.resolve() in ABOUT_WORDS or kind_of(file) not in READERS:
            continue
        name = file.resolve().relative_to(ROOT) if file.resolve().is_relative_to(ROOT) else file
        for line, words, better in findings(file.read_text(encoding="utf-8"), kind_of(file)):
            print(f"{name}:{line}: {words}: {better}")
            count += 1
    if count:
        print(f"{count} findings in {len(paths)} files")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
