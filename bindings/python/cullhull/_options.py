"""The options that long functions share: their types, their words in ``help()``, their checks.

A function takes ``**options: Unpack[Budgeted]``, say: type checkers read the names and types from
the class, and `takes` gives the function the signature and the paragraphs.
"""

from __future__ import annotations

import inspect
import re
import sys
import textwrap
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypedDict, TypeVar, Union, get_args

from . import _core
from ._arguments import as_count
from ._errors import InvalidArgument
from ._extras import needed

if TYPE_CHECKING:
    from typing_extensions import Unpack as Unpack
else:
    Unpack = Any  # checkers alone read it: Python has it from 3.11 on

#: ``progress=``: False or None for none, True for a tqdm bar, or a function of (phase, share).
Progress = Union[bool, None, Callable[[str, float], object]]

#: ``backend=``: where the filter runs.
Backend = Literal["auto", "cpu", "cuda"]
#: ``cull=``: which filter.
CullMethod = Literal["auto", "gauge", "pseudo-hull", "none"]

_CHOICES = {"backend": get_args(Backend), "cull": get_args(CullMethod)}

T = TypeVar("T")


class Threaded(TypedDict, total=False):
    threads: int | None


class Reported(TypedDict, total=False):
    progress: Progress


class Sized(TypedDict, total=False):
    memory_budget: int | None


class Steered(TypedDict, total=False):
    backend: Backend
    cull: CullMethod


class Placed(TypedDict, total=False):
    backend: Backend
    on_device: bool


class Watched(Threaded, Reported): ...


class Asked(Threaded, Reported, Placed): ...


class Kept(Threaded, Sized): ...


class Budgeted(Threaded, Sized, Reported): ...


class Standing(Threaded, Sized, Steered): ...


class Filtered(Threaded, Sized, Reported, Steered): ...


#: Of each, and of the parameters of ``save()``, what ``help()`` says, in the order of signatures.
_PARAGRAPHS = dict(
    re.findall(
        r"^(\w+) (: .*?)(?=^\w|\Z)",
        """\
backend : 'auto', 'cpu' or 'cuda'
    Where the filter runs, or points in a device's memory are asked about; 'auto' estimates which
    takes less time.
cull : 'auto', 'gauge', 'pseudo-hull' or 'none'
    The filter that discards points strictly inside before the hull is computed.
on_device : bool
    Leave the answers of points in a device's memory there, in a `DeviceArray`.
threads : int, optional
    Threads to use; all the machine offers if not given.
memory_budget : int, optional
    Bytes to allocate beyond the input; half of the machine's memory (of its container's, where that
    is less) if not given.
progress : callable or bool
    A function, called from time to time as ``progress(phase, share)`` with a share in [0, 1]; an
    exception that it raises stops the work. True shows a tqdm bar.
path : str or os.PathLike
    The extension selects the format. An existing file is replaced.
format : str
    The format, whatever the extension.
crs : str, optional
    The coordinate reference system, "EPSG:25832", for .geojson (GDAL's member ``crs``; none for WGS
    84) and for .gpkg, .fgb and .shp, which need pyogrio.
""",
        re.M | re.S,
    )
)
_DEFAULTS = {"backend": "auto", "cull": "auto", "on_device": False}


def takes(kind: Any) -> Callable[[T], T]:
    """Gives a function or a class, whose last argument is ``**options`` of such a `kind`, the
    signature and the paragraphs of these options."""
    names = [name for name in _PARAGRAPHS if name in kind.__optional_keys__]
    types = {n: getattr(t, "__forward_arg__", t) for n, t in kind.__annotations__.items()}
    keyword = inspect.Parameter.KEYWORD_ONLY
    options = [
        inspect.Parameter(name, keyword, default=_DEFAULTS.get(name), annotation=types[name])
        for name in names
    ]

    def given(thing: Any) -> Any:
        function = vars(thing).get("__init__") if isinstance(thing, type) else thing
        if function is not None:  # else the base class's has it
            signature = inspect.signature(function)
            own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
            function.__signature__ = signature.replace(parameters=[*own, *options])
        return documented(*names)(thing)

    return given


def documented(*names: str) -> Callable[[T], T]:
    """Adds the paragraphs of these parameters behind the others of a docstring."""

    def given(thing: Any) -> Any:
        text = thing.__doc__
        if text:  # there is none under python -OO
            thing.__doc__ = _with_paragraphs(text, names)
        return thing

    return given


_SECTION = re.compile(r"\n\n( *)(\w+)\n *---+\n")


def _with_paragraphs(text: str, names: tuple[str, ...]) -> str:
    sections = list(_SECTION.finditer(text))
    before = [s.end() for s in sections if s[2] == "Parameters"]
    place = min((s.start() for s in sections if s.start() > (before or [0])[0]), default=len(text))
    margin = sections[0][1] if sections else ""
    added = "" if before else "\nParameters\n----------\n"
    added += "".join(f"{name} {_PARAGRAPHS[name]}" for name in names)
    added = "\n" + textwrap.indent(added.rstrip("\n"), margin)
    return text[:place] + added + text[place:]


def require_known(options: Mapping[str, Any], kind: Any) -> None:
    """Raises Python's own error for a keyword that the calling function does not take."""
    if kind.__optional_keys__.issuperset(options):
        return
    unknown = next(name for name in options if name not in kind.__optional_keys__)
    frame = sys._getframe(1)
    while re.match("_(?!_)|settings", frame.f_code.co_name) and frame.f_back is not None:
        frame = frame.f_back
    code = frame.f_code
    name = getattr(code, "co_qualname", code.co_name)
    raise TypeError(f"{name}() got an unexpected keyword argument {unknown!r}")


def settings(options: Mapping[str, Any], kind: Any = Filtered) -> _core.Settings | None:
    """Checks the options of a call; None where all are as by default."""
    if not options:
        return None
    if not kind.__optional_keys__.issuperset(options):
        require_known(options, kind)
    get = options.get
    threads, memory_budget, progress = get("threads"), get("memory_budget"), get("progress")
    backend, cull = get("backend", "auto"), get("cull", "auto")
    steered = not backend == cull == "auto"
    if threads is None and progress is None and memory_budget is None and not steered:
        return None
    if steered and not (backend in _CHOICES["backend"] and cull in _CHOICES["cull"]):
        _refuse_choice("cull" if backend in _CHOICES["backend"] else "backend", options)
    return _core.Settings(
        backend,
        cull,
        0 if threads is None else as_count(threads, "threads", most=1024),
        0 if memory_budget is None else as_count(memory_budget, "memory_budget"),
        _as_callback(progress),
    )


def _refuse_choice(name: str, options: Mapping[str, Any]) -> NoReturn:
    value, known = options[name], ", ".join(_CHOICES[name])
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a string, not {type(value).__name__}")
    raise InvalidArgument(f"unknown {name} {value!r}; expected {known}")


def _as_callback(progress: Progress) -> Callable[[str, float], object] | None:
    if progress is None or progress is False:
        return None
    if progress is True:
        return _bar()
    if not callable(progress):
        raise TypeError("progress must be True, False, None or a function of (phase, share)")
    return progress


def _bar() -> Callable[[str, float], object]:
    tqdm = needed("tqdm.auto", "progress=True", "progress").tqdm
    bar = tqdm(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}")

    def show(phase: str, share: float) -> None:
        bar.set_description_str(phase, refresh=False)
        bar.n = min(max(share, 0.0), 1.0)
        bar.refresh()

    return show  # the bar closes when the call lets go of this
