"""Arrays that kernels hand to each other without counting references."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from numba.core import cgutils, types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

Values = TypeVar("Values")


def _borrowed(_: Any, values: Any) -> Any:
    """Typing and code of `borrowed`, for a tuple type."""

    def build(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        result = arguments[0]
        for k, kind in enumerate(values):
            if isinstance(kind, types.Array):
                view = make_array(kind)(context, builder, builder.extract_value(result, k))  # type: ignore[no-untyped-call]
                view.meminfo = cgutils.get_null_value(view.meminfo.type)  # type: ignore[no-untyped-call]
                view.parent = cgutils.get_null_value(view.parent.type)  # type: ignore[no-untyped-call]
                result = builder.insert_value(result, view._getvalue(), k)
        return result

    return values(values), build


if TYPE_CHECKING:

    def borrowed(values: Values) -> Values:
        """The tuple with its arrays as views that own nothing; valid while the caller holds the originals.

        numba counts the references to every array of a tuple at every call, by atomic additions: for small functions
        that is half of the time. What owns nothing is not counted.
        """
else:
    borrowed = intrinsic(_borrowed)
