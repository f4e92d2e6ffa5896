"""TOML, which Python 3.10 does not read by itself."""

try:
    import tomllib
except ModuleNotFoundError:  # pragma: no cover
    import tomli as tomllib  # type: ignore[no-redef]

__all__ = ["tomllib"]
