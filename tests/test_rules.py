"""The rules of CONTRIBUTING that a machine can hold: size, signatures, docstrings, names, imports."""

from __future__ import annotations

import ast
import importlib.util
import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import grimp
import pytest

from tactsim import errors

ROOT = Path(__file__).parents[1]
LONGEST_MODULE, LONGEST_FUNCTION = 300, 40
MOST_POSITIONAL, MOST_METHODS = 5, 10
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
Function = ast.FunctionDef | ast.AsyncFunctionDef
ENGINE = tuple(f"tactsim/{room}/" for room in ("analytic", "contact", "fem", "identification", "materials", "mesh", "sensors"))
HOUSEHOLD = {"found", "_found", "told", "_told", "said"}
"""Names that say nothing: a value goes by what it is."""
HOUSEHOLD |= {"WeakHold", "Memory", "PastStress", "with_past", "at_kink", "rubs", "grip", "push", "resumed", "Stretch"}
HOUSEHOLD |= {"Pace", "pace", "_pace", "carried", "_carried"}
"""Names for which the field has a word."""
HOUSEHOLD_IN_ENGINE = {"Answer"}
"""In the rooms of the engine and in mechanics: an equilibrium is none, what a worker sends back is one."""
KEYS = {
    "tactsim/dataset/ranking/measures.py: found",
    "tactsim/experiments/dma/scene.py: told",
    "tactsim/experiments/dma/report.py: told",
}
"""Keys of files, which stay."""
ARRAYS = re.compile(r"\b(?:Array|ArrayLike|ndarray)\b")
TOKEN = r"(?:\d*[a-z_]+'?|[A-Z]+|\d+|\.\.\.|\*channels)"
DIMENSION = rf"{TOKEN}(?:(?: [+*-] | ){TOKEN})*"
SHAPES = re.compile(rf"\({DIMENSION}(?:,|(?:, {DIMENSION})+),?\)|\bshapes?\b|\bbroadcast|\bone (?:for each|per)\b")
"""A shape in a docstring, such as ``(n, 3)`` or ``(size,)``, or that of another array, one value for each."""
EMPTY_NAMES = {"utils", "util", "common", "misc", "helpers", "tools", "stuff"}


@dataclass(frozen=True)
class Definition:
    """A function or class of the package: where it stands, and whether a user may name it."""

    node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
    place: str
    public: bool
    nested: bool
    method: bool


def modules() -> list[Path]:
    return sorted((ROOT / "tactsim").rglob("*.py"))


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """Every node of a module."""
    return tuple(ast.walk(tree(path)))


def below(node: ast.AST, prefix: str, *, public: bool = True, nested: bool = False) -> Iterator[Definition]:
    """Every function and class below a node, from the outer ones to the inner ones."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (*FUNCTIONS, ast.ClassDef)):
            seen = public and not child.name.startswith("_")
            place = f"{prefix}{child.name}"
            yield Definition(child, place, seen and not nested, nested, isinstance(node, ast.ClassDef))
            yield from below(child, f"{place}.", public=seen, nested=nested or isinstance(child, FUNCTIONS))
        elif not isinstance(child, ast.expr):  # which holds none
            yield from below(child, prefix, public=public, nested=nested)


@cache
def definitions() -> tuple[Definition, ...]:
    return tuple(definition for path in modules() for definition in below(tree(path), f"{path.relative_to(ROOT).as_posix()}:"))


def functions(*, public: bool = False) -> list[Definition]:
    return [
        definition for definition in definitions() if isinstance(definition.node, FUNCTIONS) and (definition.public or not public)
    ]


@cache
def own_nodes(function: ast.AST) -> tuple[ast.AST, ...]:
    """The nodes of a function without those of functions and classes within it."""
    own, waiting = [], [function]
    while waiting:
        inner = [
            child
            for child in ast.iter_child_nodes(waiting.pop())
            if not isinstance(child, (*FUNCTIONS, ast.ClassDef, ast.Lambda))
        ]
        own += inner
        waiting += inner
    return tuple(own)


def length(function: Function) -> int:
    """Lines of a function after its docstring."""
    body = function.body[1:] if ast.get_docstring(function) is not None else function.body
    return body[-1].end_lineno - body[0].lineno + 1 if body else 0


def positional(definition: Definition) -> list[ast.arg]:
    arguments = [*definition.node.args.posonlyargs, *definition.node.args.args]
    static = any(isinstance(d, ast.Name) and d.id == "staticmethod" for d in definition.node.decorator_list)
    return arguments[1:] if definition.method and not static else arguments


def annotations(function: Function) -> list[tuple[str, str]]:
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    return [(argument.arg, ast.unparse(argument.annotation) if argument.annotation else "") for argument in arguments]


def compiled(function: Function) -> bool:
    """Whether numba compiles the function: it takes arrays only, has no types, and no objects could hold its arguments."""
    return any("njit" in ast.unparse(decorator) for decorator in function.decorator_list)


def says_raises(definition: Definition) -> bool:
    return "Raises" in (ast.get_docstring(definition.node) or "")


def raises(function: Function) -> bool:
    """Whether the function itself raises anything but a signal to its own caller within the module."""
    return any(isinstance(node, ast.Raise) and node.exc is not None for node in own_nodes(function))


def names_of(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Name):
        yield node.id


# Each rule gives the places that break it.


def long_modules() -> list[str]:
    counts = {path.relative_to(ROOT).as_posix(): len(path.read_text(encoding="utf-8").splitlines()) for path in modules()}
    return [f"{path}: {count} lines" for path, count in counts.items() if count > LONGEST_MODULE]


def long_functions() -> list[str]:
    return [f"{f.place}: {length(f.node)} lines" for f in functions() if length(f.node) > LONGEST_FUNCTION]


def wide_functions() -> list[str]:
    wide = [f for f in functions() if len(positional(f)) > MOST_POSITIONAL and not compiled(f.node)]
    return [f"{f.place}: {len(positional(f))} positional arguments" for f in wide]


def packed_arguments() -> list[str]:
    """Tuples of anything, by which a function takes more arguments than it may."""
    packed = re.compile(r"tuple\[(Any|object)\b|tuple$")
    return [f"{f.place}: {name}" for f in functions() for name, kind in annotations(f.node) if packed.match(kind)]


def unlike_tuples() -> list[str]:
    """Arguments that are tuples of unlike things, which are unpacked by their places: a dataclass names them."""
    return [
        f"{f.place}: {argument.arg}"
        for f in functions()
        for argument in (*f.node.args.posonlyargs, *f.node.args.args, *f.node.args.kwonlyargs)
        if argument.annotation is not None and any(len(kinds) > 1 for kinds in kinds_in_tuples(argument.annotation))
    ]


def kinds_in_tuples(annotation: ast.expr) -> list[set[str]]:
    """The kinds of entries of a tuple that an argument may be; an entry that may be missing is of the same kind."""
    if isinstance(annotation, ast.BinOp):
        return kinds_in_tuples(annotation.left) + kinds_in_tuples(annotation.right)
    if not isinstance(annotation, ast.Subscript) or ast.unparse(annotation.value) != "tuple":
        return []
    entries = annotation.slice.elts if isinstance(annotation.slice, ast.Tuple) else [annotation.slice]
    return [{kind for entry in entries for kind in [kind_of(entry)] if kind != "..."}]


def kind_of(entry: ast.expr) -> str:
    """What an entry is: itself without the limits of ``Annotated``, of a choice the kind of its first value."""
    if isinstance(entry, ast.BinOp):
        return kind_of(entry.left)
    if isinstance(entry, ast.Subscript) and ast.unparse(entry.value) in ("Annotated", "Literal"):
        first = entry.slice.elts[0] if isinstance(entry.slice, ast.Tuple) else entry.slice
        kind = type(first.value).__name__ if isinstance(first, ast.Constant) else ast.unparse(first)
        return "float" if kind == "int" else kind
    return "..." if isinstance(entry, ast.Constant) and entry.value is ... else ast.unparse(entry)


def untyped_arguments() -> list[str]:
    return [
        f"{f.place}: {name}"
        for f in functions(public=True)
        for name, kind in annotations(f.node)
        if not kind and name not in ("self", "cls") and not compiled(f.node)
    ]


def large_classes() -> list[str]:
    large = []
    for definition in definitions():
        if isinstance(definition.node, ast.ClassDef):
            methods = [n for n in definition.node.body if isinstance(n, FUNCTIONS) and not n.name.startswith("_")]
            if len(methods) > MOST_METHODS:
                large.append(f"{definition.place}: {len(methods)} public methods")
    return large


def undocumented() -> list[str]:
    silent = [path.relative_to(ROOT).as_posix() for path in modules() if ast.get_docstring(tree(path)) is None]
    return silent + [f.place for f in definitions() if f.public and not overloaded(f.node) and ast.get_docstring(f.node) is None]


def overloaded(node: ast.AST) -> bool:
    """Whether it is but a signature of the function that follows."""
    return any(isinstance(mark, ast.Name) and mark.id == "overload" for mark in getattr(node, "decorator_list", []))


def silent_about_errors() -> list[str]:
    """Public functions that raise and have no section that says what."""
    return [f.place for f in functions(public=True) if not says_raises(f) and raises(f.node)]


def classes_silent_about_errors() -> list[str]:
    """Public classes that raise as they are made and whose docstring does not name the error, nor a base class of it."""
    made = [
        (c, part)
        for c in definitions()
        if isinstance(c.node, ast.ClassDef) and c.public
        for part in c.node.body
        if isinstance(part, FUNCTIONS) and part.name in ("__init__", "__post_init__")
    ]
    return [
        f"{c.place}: {name}"
        for c, part in made
        for name in sorted(errors_raised(part))
        if not {base.__name__ for base in getattr(errors, name).__mro__[:-1]} & words_of(c)
    ]


def helpers_errors_left_unsaid() -> list[str]:
    """Public functions that do not say what they raise although a private helper of their module raises it in them."""
    helpers: dict[str, list[Function]] = {}
    for f in functions():
        if f.node.name.startswith("_") and not f.nested and errors_raised(f.node) and not yields(f.node):
            helpers.setdefault(f.place.partition(":")[0], []).append(f.node)
    return [
        f"{f.place}: {helper.name}"
        for f in functions(public=True)
        if not re.search(r"\b[Rr]aises\b", ast.get_docstring(f.node) or "")
        for helper in helpers.get(f.place.partition(":")[0], ())
        if helper.name in private_calls(f.node) and not errors_raised(helper) & words_of(f)
    ]


def yields(function: Function) -> bool:
    """Whether a call of it only makes a generator."""
    return any(isinstance(node, (ast.Yield, ast.YieldFrom)) for node in own_nodes(function))


def private_calls(function: Function) -> set[str]:
    """Names of private functions, and of private methods of the same object, that a function calls where it catches nothing."""
    caught = {
        id(inner) for node in own_nodes(function) if isinstance(node, ast.Try) for part in node.body for inner in ast.walk(part)
    }
    calls = (node.func for node in own_nodes(function) if isinstance(node, ast.Call) and id(node) not in caught)
    return {
        name for call in calls for name in [call.id if isinstance(call, ast.Name) else own_method(call)] if name.startswith("_")
    }


def own_method(call: ast.expr) -> str:
    own = isinstance(call, ast.Attribute) and isinstance(call.value, ast.Name) and call.value.id in ("self", "cls")
    return call.attr if own else ""


def words_of(definition: Definition) -> set[str]:
    return set(re.findall(r"\w+", ast.get_docstring(definition.node) or ""))


def time_limits_left_unsaid() -> list[str]:
    """Public functions that look at the time limit and do not say that they end when it has passed."""
    return [
        f.place
        for f in functions(public=True)
        if any(isinstance(node, ast.Name) and node.id == "check_time" for node in own_nodes(f.node))
        and not {"OutOfTime", "Unfinished", "TactsimError"} & named_errors(f)
    ]


def errors_left_unsaid() -> list[str]:
    """Errors of this package that a public function raises and that its section neither names nor names a base class of."""
    return [
        f"{f.place}: {name}"
        for f in functions(public=True)
        for name in sorted(errors_raised(f.node))
        if not {base.__name__ for base in getattr(errors, name).__mro__} & named_errors(f)
    ]


@cache
def errors_raised(function: Function) -> set[str]:
    """Names of errors that leave a function where it raises them itself: not those that it catches again."""
    tries = [node for node in own_nodes(function) if isinstance(node, ast.Try) and node.handlers]
    caught = {id(inner) for node in tries for part in node.body for inner in (part, *own_nodes(part))}
    raised = (node.exc for node in own_nodes(function) if isinstance(node, ast.Raise) and node.exc and id(node) not in caught)
    names = {name for error in raised for name in names_of(error.func if isinstance(error, ast.Call) else error)}
    return {name for name in names if isinstance(getattr(errors, name, None), type)}


def named_errors(definition: Definition) -> set[str]:
    section = (ast.get_docstring(definition.node) or "").partition("Raises\n------\n")[2]
    return {name for line in re.findall(r"^\w+(?:, \w+)*$", section, re.M) for name in line.split(", ")}


def shapes_left_unsaid() -> list[str]:
    """Public functions that take or return arrays and whose docstring gives no shape."""
    return [
        f.place
        for f in functions(public=True)
        if handles_arrays(f.node) and not overloaded(f.node) and not SHAPES.search(ast.get_docstring(f.node) or "")
    ]


def handles_arrays(function: Function) -> bool:
    returned = ast.unparse(function.returns) if function.returns else ""
    return any(ARRAYS.search(kind) for kind in (returned, *dict(annotations(function)).values()))


def other_ends_of_runs() -> list[str]:
    """Modules that handle an interruption beside ``interfaces.run``, where every run ends, and the commands and sweeps above."""
    allowed = ("tactsim/interfaces/run.py", "tactsim/cli/", "tactsim/dataset/running/whole.py")
    handled = (
        (path.relative_to(ROOT).as_posix(), node)
        for path in modules()
        for node in nodes(path)
        if isinstance(node, ast.ExceptHandler) and node.type is not None
    )
    return [
        f"{place}:{node.lineno}"
        for place, node in handled
        if not place.startswith(allowed) and "KeyboardInterrupt" in ast.unparse(node.type)
    ]


def empty_names() -> list[str]:
    return [
        path.relative_to(ROOT).as_posix() for path in modules() if EMPTY_NAMES & set(path.relative_to(ROOT).with_suffix("").parts)
    ]


def household_names() -> list[str]:
    """Functions, arguments and variables by a household word."""
    broken = set()
    for path in modules():
        place = path.relative_to(ROOT).as_posix()
        words = HOUSEHOLD | (HOUSEHOLD_IN_ENGINE if place.startswith((*ENGINE, "tactsim/mechanics/")) else set())
        for node in nodes(path):
            names = {name for name in map(vars(node).get, ("name", "id", "attr", "arg")) if isinstance(name, str)}
            broken |= {f"{place}: {name}" for name in names & words}
    return sorted(broken - KEYS)


def array_types() -> list[str]:
    """Modules of the package and of the tests, but ``tactsim.array``, that define a type of arrays of their own."""
    own = re.compile(r"^Array\b.*=", re.M)
    places = [*modules(), *sorted((ROOT / "tests").rglob("*.py"))]
    texts = {path: path.read_text(encoding="utf-8") for path in places if path.name != "array.py"}
    return [path.relative_to(ROOT).as_posix() for path, text in texts.items() if own.search(text)]


def printing() -> list[str]:
    calls = ((path, node) for path in modules() for node in nodes(path) if isinstance(node, ast.Call))
    return [f"{path.relative_to(ROOT)}:{node.lineno}" for path, node in calls if "print" in names_of(node.func)]


def machine_paths() -> list[str]:
    """Folders of one machine in the package, the cases or the tests."""
    place = re.compile(r"/(?:home|Users|work|root)/\w+/|[A-Z]:\\\\Users")
    scripts = (path for path in ROOT.glob("scripts/*") if path.is_file())  # compiled ones lie in a folder beside them
    texts = [*modules(), *ROOT.glob("cases/**/*.yaml"), *scripts, *ROOT.glob("*.md")]
    return [path.relative_to(ROOT).as_posix() for path in texts if place.search(path.read_text(encoding="utf-8"))]


RULES: list[Callable[[], list[str]]] = [
    long_modules,
    long_functions,
    wide_functions,
    packed_arguments,
    unlike_tuples,
    untyped_arguments,
    large_classes,
    undocumented,
    silent_about_errors,
    classes_silent_about_errors,
    helpers_errors_left_unsaid,
    time_limits_left_unsaid,
    errors_left_unsaid,
    shapes_left_unsaid,
    other_ends_of_runs,
    empty_names,
    array_types,
    household_names,
    printing,
    machine_paths,
]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_the_rule_holds_everywhere(rule):
    assert rule() == []


BROKEN = {
    long_functions: "def f():\n" + "    a = 1\n" * 41,
    wide_functions: "def f(a, b, c, d, e, g): ...",
    packed_arguments: "def f(forces: tuple[Any, ...]): ...",
    unlike_tuples: "def f(run: tuple[str, float] | None, ends: tuple[float, float | None], corner: tuple[int, ...]): ...",
    untyped_arguments: "def f(a): ...",
    large_classes: "class A:\n" + "".join(f"    def m{k}(self): ...\n" for k in range(11)),
    undocumented: '"""A module."""\ndef f(): ...',
    silent_about_errors: 'def f():\n    """F."""\n    raise ValueError',
    classes_silent_about_errors: 'class A:\n    """A."""\n    def __post_init__(self):\n        raise InvalidQuantity',
    helpers_errors_left_unsaid: 'def f():\n    """F."""\n    _g()\ndef _g():\n    raise CaseError',
    time_limits_left_unsaid: 'def f():\n    """F."""\n    check_time()',
    errors_left_unsaid: 'def f():\n    """F.\n\n    Raises\n    ------\n    CaseError\n    """\n    raise StorageError',
    shapes_left_unsaid: 'def f(a: Array | None) -> None:\n    """A of b."""',
    other_ends_of_runs: "try:\n    a = 1\nexcept (ValueError, KeyboardInterrupt):\n    pass",
    array_types: "Array = np.ndarray",
    household_names: "found = 1",
    printing: "print(1)",
    machine_paths: "PLACE = '" + "/home/" + "someone/case.yaml'",
}


@pytest.mark.parametrize("rule", BROKEN, ids=lambda rule: rule.__name__)
def test_a_module_that_breaks_a_rule_is_found(rule, tmp_path, monkeypatch):
    (tmp_path / "tactsim").mkdir()
    (tmp_path / "tactsim" / "wrong.py").write_text(BROKEN[rule])
    monkeypatch.setattr("sys.modules", dict(__import__("sys").modules))
    monkeypatch.setitem(rule.__globals__, "ROOT", tmp_path)
    definitions.cache_clear()
    try:
        assert len(rule()) == 1
    finally:
        definitions.cache_clear()


@cache
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("tactsim", cache_dir=None)


def cycles(imports: dict[str, set[str]]) -> list[list[str]]:
    """Groups of modules each of which imports the others, directly or not: the strongly connected components (Tarjan 1972)."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(module: str) -> None:
        order[module] = lowest[module] = len(order)
        stack.append(module)
        for other in sorted(imports[module]):
            if other not in order:
                visit(other)
                lowest[module] = min(lowest[module], lowest[other])
            elif other in stack:
                lowest[module] = min(lowest[module], order[other])
        if lowest[module] == order[module]:
            group = stack[stack.index(module) :]
            del stack[stack.index(module) :]
            if len(group) > 1:
                groups.append(sorted(group))

    for module in sorted(imports):
        if module not in order:
            visit(module)
    return groups


def test_no_two_modules_import_each_other_not_even_for_types():
    imports = {module: set(graph().find_modules_directly_imported_by(module)) for module in graph().modules}
    assert cycles(imports) == []
    first, second = "tactsim.fem.assembly.body", "tactsim.interfaces"
    assert second in imports[first]
    assert cycles(imports | {second: imports[second] | {first}}) != []


def test_contributing_prints_the_layers_and_fences_that_pyproject_holds():
    spec = importlib.util.spec_from_file_location("print_rules", ROOT / "scripts" / "print_rules.py")
    printing_script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(printing_script)
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert text == printing_script.with_printed_rules(text), "run: python scripts/print_rules.py"


def test_the_tests_that_contributing_names_exist():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = re.findall(r"`((?:tests/[\w/]+/)?test_\w+\.py)`", text)
    assert len(named) > 10
    missing = [name for name in named if not (ROOT / (name if "/" in name else f"tests/contract/{name}")).is_file()]
    assert missing == []


def test_every_dependency_is_locked():
    """What the package needs stands in each lock, so that a fresh checkout has it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = {re.split(r"[^\w.-]", line)[0].replace("-", ".") for line in project["dependencies"]}
    for lock in sorted(ROOT.glob("requirements*.lock")):
        locked = {line.split("==")[0].strip().replace("-", ".") for line in lock.read_text(encoding="utf-8").splitlines()}
        assert needed <= locked, f"{lock.name} lacks {', '.join(sorted(needed - locked))}"
