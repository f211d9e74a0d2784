from typing import TypeVar

_T = TypeVar("_T")
_K = TypeVar("_K")

class RepeatedScalarFieldContainer(list[_T]): ...

class RepeatedCompositeFieldContainer(list[_T]):
    def add(self, **fields: object) -> _T: ...

class ScalarMap(dict[_K, _T]): ...
