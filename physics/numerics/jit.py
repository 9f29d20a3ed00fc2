"""Decorators that compile kernels with numba and cache them on disk. Without numba the kernels run as plain Python.

The cache is discarded after an edit of any kernel source, because the machine code of a kernel contains the kernels
that it calls. Kernels called by their entry address (`called_at`) are the exception.
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
except ImportError:  # Numba is not available for this machine: the same functions run as plain Python.

    def jit(function: Kernel) -> Kernel:
        """Return the function itself, uncompiled."""
        return function

    inlined = piece = whole = jit

else:
    # Reference counts of arrays are switched off. Kernels allocate no arrays, and counting references to views took
    # half of the run time.
    COUNTED = False
    _FOLDER = str(cache_folder())
    ENVIRONMENT = "_ZN08NumbaEnv"  # prefix of the names of numba's environment variables in the machine code

    @contextmanager
    def _own_folder() -> Iterator[None]:
        """Within this context, store compiled code in our own folder. Other users of numba keep their setting."""
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, _FOLDER
        try:
            yield
        finally:
            numba.config.CACHE_DIR = before

    def _compiled(function: Kernel, **options: object) -> Kernel:
        # The option is set even if it is False: code compiled on behalf of an inlined caller would otherwise be inlined
        # as well.
        options = {"forceinline": False, **options}
        with _own_folder():
            compiled: Kernel = numba.njit(cache=True, nogil=True, error_model="numpy", _nrt=COUNTED, **options)(
                function
            )
        return compiled

    class _Optimized(Compiler):  # type: ignore[misc]  # numba has no types
        """Numba's compiler with hooks that change how the code of a function and of its callees is optimised."""

        def compile_extra(self, function: Any) -> Any:
            # a library that is stored in the cache, with our own optimisation step
            library = self.state.targetctx.codegen().create_library(function.__qualname__)
            library.enable_object_caching()
            library._optimize_final_module = partial(self.optimize, library)
            self.prepare(library)
            self.state.library = library
            return super().compile_extra(function)

        def prepare(self, library: Any) -> None:
            """Do nothing; a subclass may change how the library is finalised."""

        def optimize(self, library: Any) -> None:
            """Leave the code unoptimised: it is optimised together with the functions that call it."""

    class _Inlined(_Optimized):
        """Compiler for functions that only exist inside their callers.

        Skipping the machine code of these functions saves a fifth of the compile time.
        """

        def prepare(self, library: Any) -> None:
            library._finalize_final_module = partial(self.finish, library)

        def finish(self, library: Any) -> None:
            """Keep the intermediate code for the callers. Compile only the environment variables, which numba has registered."""
            library._finalized = True
            library._shared_module = library._get_module_for_linking()
            names = [found.name for found in library._final_module.global_variables]
            library._final_module = parse_assembly(
                "\n".join(f'@"{name}" = common global ptr null' for name in names if name.startswith(ENVIRONMENT))
            )
            type(library)._finalize_final_module(library)

    class _Whole(_Optimized):
        def optimize(self, library: Any) -> None:
            """Make all called functions private to this one and optimise.

            LLVM then inlines every function that is called only once. The linkage is private, not internal: a kernel
            loaded later would find an internal name and call the optimised version. Vectorisation is off because rows
            of beads are short, so vector code would cost more than it saves.
            """
            # linkonce_odr is the linkage that numba gives to called functions
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
        """Compile `function` on its first call and store the result on disk under the digest of all kernel sources.

        Kernels do not touch Python objects and release the interpreter lock, so other threads keep running.
        """
        return _compiled(function)

    def inlined(function: Kernel) -> Kernel:
        """Compile `function` into its callers.

        A real call that passes whole records would cost as much as a step of a few contacts. Python cannot call the
        result: a wrapper for that would take a tenth of the compile time.
        """
        return _compiled(
            function, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, pipeline_class=_Inlined
        )

    def whole(function: Kernel) -> Kernel:
        """Compile a kernel that Python calls, optimised together with its `piece` functions.

        The kernel then takes three quarters of the time.
        """
        return _compiled(function, pipeline_class=_Whole)

    def piece(function: Kernel) -> Kernel:
        """Compile a function that a `whole` kernel calls. It is slow if Python calls it directly."""
        return _compiled(function, pipeline_class=_Optimized)


def _called_here(entry: Any, arguments: tuple[Any, ...]) -> Any:
    """Call a kernel directly; the plain-Python form of `called_at`."""
    return entry(*arguments)


if COMPILED:

    @intrinsic
    def called_at(typing_context, entry, arguments):
        """Call the kernel whose machine code begins at address `entry`; return its status and time.

        The kernel is not compiled again into the caller.
        """
        found = types.Tuple((types.int64, types.float64))

        def generate(context, builder, signature, values):
            kinds, convention = list(signature.args[1]), context.call_conv
            # turn the address into a function pointer with the calling convention of numba
            kernel = builder.inttoptr(values[0], convention.get_function_type(found, kinds).as_pointer())
            unpacked = [builder.extract_value(values[1], k) for k in range(len(kinds))]
            status, result = convention.call_function(builder, kernel, found, kinds, unpacked)
            # pass an error of the kernel on to the caller
            with cgutils.if_unlikely(builder, status.is_error):
                convention.return_status_propagate(builder, status)
            return result

        return found(types.int64, arguments), generate

    called_at.py_func = _called_here
else:
    called_at = _called_here


def c_function(function: Kernel, signature: Any) -> Any:
    """Return `function` as machine code that C code can call by its ``address``. It is compiled at once and cached on disk.

    Raises ImportError without numba, and RuntimeError if NUMBA_DISABLE_JIT is set.
    """
    import numba

    if numba.config.DISABLE_JIT:
        raise RuntimeError("NUMBA_DISABLE_JIT switches compiled code off")
    with _own_folder():
        return numba.cfunc(signature, cache=True, error_model="numpy")(function)
