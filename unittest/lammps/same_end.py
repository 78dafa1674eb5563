"""The end of a run, which neither ranks nor newton nor a restart may change."""
import numpy as np

from host import allowed
from system import dump_lines, lmp, read_dump


def same_end_on_ranks(folder, script, steps, columns, before_restart):
    """script(lines, newton=.., begin=a restart file) makes an input that ends in these lines. Returns the rows of the
    last step of one rank."""
    def end(runs, ranks=1, **options):
        lmp(folder, script(dump_lines("end.dump", steps, columns) + runs, **options), ranks)
        return read_dump(str(folder / "end.dump"))[-1][1]

    whole = end([f"run {steps}"])
    for ranks, newton in allowed((2, "on"), (4, "off")):
        assert np.abs(end([f"run {steps}"], ranks, newton=newton) - whole).max() < 1e-10
    lmp(folder, script([f"run {before_restart}", "write_restart half"]))
    assert np.abs(end([f"run {steps - before_restart}"], begin="half") - whole).max() < 1e-10
    return whole
