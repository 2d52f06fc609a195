"""How large a drawing may be. Beyond a limit reading stops with a `LimitError` that states it."""

from __future__ import annotations

MAX_BYTES = 50_000_000
"""bytes of a file, and of what a compressed one expands to"""

MAX_DEPTH = 200
"""elements nested in one another, copies made by `use` included"""

MAX_NODES = 100_000
"""XML elements in a file"""

MAX_ATTRIBUTES = 1_000_000
"""attributes in a file"""

MAX_OWN_ATTRIBUTES = 1_000
"""attributes of one element: looking one up takes time in proportion to their number"""

MAX_ENTITIES = 100
"""text entities that a file declares"""

MAX_ENTITY_CHARS = 1_000
"""characters of one such entity"""

MAX_ELEMENTS = 100_000
"""elements visited once every `use` is replaced by a copy"""

MAX_TEXT = 200_000_000
"""characters of attributes read once every `use` is replaced by a copy"""

MAX_SEGMENTS = 1_000_000
"""lines and curves of a whole drawing"""

MAX_STYLE_CHARS = 1_000_000
"""characters of all style sheets together, and again of all unusual `style` attributes"""

MAX_INLINE_CHARS = 100_000
"""characters of one `style` attribute"""

MAX_STYLE_RULES = 2_000
"""selectors of all style sheets together"""

MAX_STYLE_STEPS = 10_000_000
"""comparisons of selectors with elements"""

MAX_TRANSFORM_CHARS = 10_000
"""characters of one transform"""
