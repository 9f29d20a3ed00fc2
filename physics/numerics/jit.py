"""`jit`: numba's njit with a disk cache that an edit of any kernel empties; plain Python where numba is not to be had.

What a kernel calls becomes part of its machine code, but for a kernel that it calls by its entry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, TypeVar

from softcradle.physics.numerics.float_bits import COMPILED
from softcradle.physics.numerics.kernel_cache import cache_folder

Kernel = TypeVar("Kernel", bound=Callable[..., object])


try:
    import numba
    from llvmlite.binding import Linkage, parse_assembly
    from numba import types
    from numba.core import cgutils
    from numba.core.compiler import Compiler
    from numba.extending import intrinsic
except ImportError:  # no wheel for this machine: the same functions run as plain Python

    def jit(function: Kernel) -> Kernel:
        """The function itself, uncompiled."""
        return function

    inlined = piece = whole = jit

else:
    # references to arrays: kernels make no array, and counting references to views took half of the time
    COUNTED = False
    _FOLDER = str(cache_folder())
    ENVIRONMENT = "_ZN08NumbaEnv"  # what numba's names of environments begin with

    @contextmanager
    def _own_folder() -> Iterator[None]:
        """Within it, what is decorated is kept in our folder; other users of numba keep theirs."""
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, _FOLDER
        try:
            yield
        finally:
            numba.config.CACHE_DIR = before

    def _compiled(function: Kernel, **options: object) -> Kernel:
        # said even where False: what is compiled on behalf of an inlined caller would be inlined as that is
        options = {"forceinline": False, **options}
        with _own_folder():
            compiled: Kernel = numba.njit(cache=True, nogil=True, error_model="numpy", _nrt=COUNTED, **options)(
                function
            )
        return compiled

    class _Optimized(Compiler):  # type: ignore[misc]  # numba has no types
        """The usual compiler, but for what is done with the code of a function and of all that it calls."""

        def compile_extra(self, function: Any) -> Any:
            library = self.state.targetctx.codegen().create_library(function.__qualname__)
            library.enable_object_caching()
            library._optimize_final_module = partial(self.optimize, library)
            self.prepare(library)
            self.state.library = library
            return super().compile_extra(function)

        def prepare(self, library: Any) -> None:
            """Nothing more."""

        def optimize(self, library: Any) -> None:
            """Leave the code as it comes, for those who call the function."""

    class _Inlined(_Optimized):
        """For what its callers alone take: no machine code is made of it, which saves a fifth of the time."""

        def prepare(self, library: Any) -> None:
            library._finalize_final_module = partial(self.finish, library)

        def finish(self, library: Any) -> None:
            """Keep the code for those that call it; what is compiled is the environment, of which numba keeps note."""
            library._finalized = True
            library._shared_module = library._get_module_for_linking()
            names = [found.name for found in library._final_module.global_variables]
            library._final_module = parse_assembly(
                "\n".join(f'@"{name}" = common global ptr null' for name in names if name.startswith(ENVIRONMENT))
            )
            type(library)._finalize_final_module(library)

    class _Whole(_Optimized):
        def optimize(self, library: Any) -> None:
            """Optimise what is called as private to the function: LLVM then inlines all that is called but once.

            Private, not internal: kernels that are loaded later would find an internal name, and call what LLVM has made of it.
            Rows are short: vector code would cost more than it brings.
            """
            for called in library._final_module.functions:
                if not called.is_declaration and called.linkage == Linkage.linkonce_odr:
                    called.linkage = Linkage.private
            before = numba.config.LOOP_VECTORIZE, numba.config.SLP_VECTORIZE
            numba.config.LOOP_VECTORIZE = numba.config.SLP_VECTORIZE = 0
            try:
                type(library)._optimize_final_module(library)
            finally:
                numba.config.LOOP_VECTORIZE, numba.config.SLP_VECTORIZE = before

    def jit(function: Kernel) -> Kernel:
        """Compile `function` on its first call; keep the result on disk under the digest of all kernel sources.

        Kernels touch nothing of Python's, so other threads run on beside them.
        """
        return _compiled(function)

    def inlined(function: Kernel) -> Kernel:
        """`jit`, put into its caller: a call that passes whole records costs as much as a step of a few contacts.

        Python cannot call it; code for that would take a tenth of the time to compile.
        """
        return _compiled(
            function, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, pipeline_class=_Inlined
        )

    def whole(function: Kernel) -> Kernel:
        """`jit` for a kernel that Python calls, optimised together with its pieces: it runs in three quarters of the time."""
        return _compiled(function, pipeline_class=_Whole)

    def piece(function: Kernel) -> Kernel:
        """`jit` for what a `whole` kernel calls: slow where Python calls it."""
        return _compiled(function, pipeline_class=_Optimized)


def _called_here(entry: Any, arguments: tuple[Any, ...]) -> Any:
    """What a kernel gives that is called as plain Python."""
    return entry(*arguments)


if COMPILED:

    @intrinsic
    def called_at(typing_context, entry, arguments):
        """The status and the time that a kernel gives whose machine code begins at `entry`: it is not made once more here."""
        found = types.Tuple((types.int64, types.float64))

        def generate(context, builder, signature, values):
            kinds, convention = list(signature.args[1]), context.call_conv
            kernel = builder.inttoptr(values[0], convention.get_function_type(found, kinds).as_pointer())
            unpacked = [builder.extract_value(values[1], k) for k in range(len(kinds))]
            status, result = convention.call_function(builder, kernel, found, kinds, unpacked)
            with cgutils.if_unlikely(builder, status.is_error):
                convention.return_status_propagate(builder, status)
            return result

        return found(types.int64, arguments), generate

    called_at.py_func = _called_here
else:
    called_at = _called_here


def c_function(function: Kernel, signature: Any) -> Any:
    """`function` as machine code that C calls by its ``address``, compiled at once and kept on disk with the kernels.

    Raises ImportError without numba, RuntimeError where NUMBA_DISABLE_JIT switches it off.
    """
    import numba

    if numba.config.DISABLE_JIT:
        raise RuntimeError("NUMBA_DISABLE_JIT switches compiled code off")
    with _own_folder():
        return numba.cfunc(signature, cache=True, error_model="numpy")(function)
