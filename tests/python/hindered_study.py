"""`bipenalty.study` with cases that take time, or whose process dies: workers run this file again, and so get both."""

import os
import sys
import time

from bipenalty import _cases, study

_run = _cases.Case.run


def _hindered(case: _cases.Case) -> dict[str, object]:
    time.sleep(float(os.environ.get("PAUSE", "0")))
    if str(case.parameters.get("elements")) == os.environ.get("DIES_AT"):
        os._exit(9)
    return _run(case)


_cases.Case.run = _hindered  # type: ignore[method-assign]

if __name__ == "__main__":
    sys.exit(study.main())
