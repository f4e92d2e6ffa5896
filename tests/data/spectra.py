"""Largest eigenvalues in extended precision: makes critical_courant.csv and work_precision.csv, or checks them.

    python3 spectra.py critical_courant > critical_courant.csv        about 3 minutes; needs Python alone
    python3 spectra.py work_precision > work_precision.csv            about 2 minutes
    python3 spectra.py work_precision --check FILE --every 7          makes every 7th row anew; exit status 1 if one differs

Nothing here follows the program that is tested: K + s ZZ' and M + m ZZ' are summed plainly, and the inertia of K - l M
(is it negative definite?) is bisected on l in decimal arithmetic of 100 digits. Bars have E = rho = A = h = 1 unless a
problem says otherwise; every other input is an integer or a binary fraction, so that f64 holds it exactly.
"""

import argparse
import sys
from decimal import Decimal as D
from decimal import getcontext

getcontext().prec = 100
FREE, FIXED, WALL = "free", "fixed", "wall"
INF = D("inf")


class Rows:
    """Diagonals and off-diagonals of K and M, grown bar by bar."""

    def __init__(self):
        self.kd, self.ko, self.md, self.mo = [], [], [], []

    def bar(self, elements):
        """Appends a bar; elements are (k, a, b): K_e = k [1 -1; -1 1], M_e = [a b; b a]."""
        if self.kd:
            self.ko.append(D(0))
            self.mo.append(D(0))
        first = len(self.kd)
        self.kd += [D(0)] * (len(elements) + 1)
        self.md += [D(0)] * (len(elements) + 1)
        for i, (k, a, b) in enumerate(elements, first):
            self.kd[i] += k
            self.kd[i + 1] += k
            self.md[i] += a
            self.md[i + 1] += a
            self.ko.append(-k)
            self.mo.append(b)

    def contact(self, nodes, s, m):
        """Adds s ZZ' and m ZZ' of a wall (one node) or of a pair of neighbours."""
        for d, o, x in ((self.kd, self.ko, s), (self.md, self.mo, m)):
            for node in nodes:
                d[node] += x
            if len(nodes) == 2:
                o[nodes[0]] -= x

    def without(self, left, right):
        """The same without its first or its last node."""
        end = len(self.kd) - right
        self.kd, self.md = self.kd[left:end], self.md[left:end]
        self.ko, self.mo = self.ko[left : end - 1], self.mo[left : end - 1]


def is_above(rows, l):
    """Whether K - l M is negative definite."""
    kd, ko, md, mo = rows.kd, rows.ko, rows.md, rows.mo
    pivot = kd[0] - l * md[0]
    for i in range(1, len(kd)):
        if pivot >= 0:
            return False
        off = ko[i - 1] - l * mo[i - 1]
        pivot = kd[i] - l * md[i] - off * off / pivot
    return pivot < 0


def largest(rows, digits):
    """l_max to `digits` digits."""
    # A single node gives a lower bound; doubling finds an upper one.
    low = max(k / m for k, m in zip(rows.kd, rows.md)) / 2
    high = 2 * low
    while not is_above(rows, high):
        low, high = high, 2 * high
    while high - low > low * D(10) ** -digits:
        middle = (low + high) / 2
        if is_above(rows, middle):
            high = middle
        else:
            low = middle
    return (low + high) / 2


def uniform(n, gamma, modulus=1, area=1):
    """n elements with h = rho = 1."""
    k, m = D(modulus * area), D(area) / 6
    return [(k, (2 + gamma) * m, (1 - gamma) * m)] * n


def penalty(beta_s, ratio, gamma, stiffness=1, rate=1):
    """s and m of a contact between elements whose smaller EA/h is `stiffness` and whose larger E/(rho h^2) is `rate`."""
    s = beta_s * stiffness
    return s, D(0) if ratio == INF else s * (1 + 2 * gamma) / (12 * ratio * rate)


# ---- critical_courant --------------------------------------------------------------------------------------------


def critical_courant():
    """Keys and makers of the rows of critical_courant.csv."""
    for scene in ("signorini", "symmetric", "hunek"):
        for n in (1, 2, 10, 100):
            for gamma in ("0", "0.5", "1"):
                for beta_s in ("0", "1e-8", "0.5", "1", "10", "1e4", "1e8", "1e12"):
                    for ratio in ("0.25", "0.5", "1", "2", "3", "inf"):
                        key = (scene, n, gamma, beta_s, ratio)
                        yield key, lambda key=key: courant(*key)


def courant(scene, n, gamma, beta_s, ratio):
    gamma, (s, m) = D(gamma), penalty(D(beta_s), D(ratio), D(gamma))
    rows = Rows()
    rows.bar(uniform(n, gamma))
    if scene == "signorini":
        rows.contact([n], s, m)
    else:
        rows.bar(uniform(n if scene == "symmetric" else 2 * n, gamma))
        rows.contact([n, n + 1], s, m)
    rows.without(0, int(scene == "hunek"))
    omega = largest(rows, 40).sqrt()
    return [digits(2 / omega), digits(omega)]


# ---- work_precision ----------------------------------------------------------------------------------------------


def work_precision():
    """Keys and makers of the rows of work_precision.csv."""
    for problem in (wall_consistent, unequal_lumped, stiff_lumped, random_consistent):
        for n in (10, 100, 1000, 10_000, 100_000):
            name = problem.__name__.replace("_", "-")
            yield (name, n), lambda problem=problem, n=n: nearest_and_rest(largest(problem(n), 34))


def wall_consistent(n):
    """A bar on a wall, consistent mass, beta_s = 10, r = 2: the contact mode lies apart, above the bar's."""
    rows = Rows()
    rows.bar(uniform(n, D(0)))
    rows.contact([n], *penalty(D(10), D(2), D(0)))
    return rows


def unequal_lumped(n):
    """n/2 elements with E = 1, n/2 with E = 2, A = 3 and a fixed end, lumped mass, beta_s = 1e4, r = 1: the largest of a
    crowd whose gaps shrink like 1/n^2."""
    rows = Rows()
    rows.bar(uniform(n // 2, D(1)))
    rows.bar(uniform(n // 2, D(1), modulus=2, area=3))
    rows.contact([n // 2, n // 2 + 1], *penalty(D(10) ** 4, D(1), D(1), rate=2))
    rows.without(0, 1)
    return rows


def stiff_lumped(n):
    """A bar on a wall, lumped mass, beta_s = 1e8, r = inf: pure penalty."""
    rows = Rows()
    rows.bar(uniform(n, D(1)))
    rows.contact([n], *penalty(D(10) ** 8, INF, D(1)))
    return rows


def random_consistent(n):
    """Elements with k, d in {64, .., 127}/64 by a linear congruential generator, M_e = d [2 1; 1 2], on a wall with s = m = 16:
    the largest of a crowd of modes, each of which lives in a few elements."""
    state, elements = 189, []

    def draw():
        nonlocal state
        state = (6364136223846793005 * state + 1442695040888963407) % 2**64
        return D(64 + (state >> 58)) / 64

    for _ in range(n):
        k, d = draw(), draw()
        elements.append((k, 2 * d, d))
    rows = Rows()
    rows.bar(elements)
    rows.contact([n], D(16), D(16))
    return rows


# ---- tables ------------------------------------------------------------------------------------------------------


def digits(x):
    """30 significant digits without trailing zeros."""
    text = f"{x:.29e}"
    return f"{D(text).normalize():f}"


def nearest_and_rest(x):
    """The nearest f64 and what is left of x: errors below a unit in the last place stay visible."""
    return [repr(float(x)), repr(float(x - D(float(x))))]


TABLES = {
    "critical_courant": (
        "scene,elements_first_bar,gamma,stiffness_penalty,ratio,critical_courant,omega_max_h_over_c0",
        critical_courant,
    ),
    "work_precision": ("problem,elements,l_max [rad^2/s^2],rest of l_max [rad^2/s^2]", work_precision),
}


def same(a, b):
    """Equal to 28 digits; a remainder is compared beside the value that it belongs to."""
    return abs(D(a) - D(b)) <= D(10) ** -28 * max(abs(D(a)), abs(D(b)))


def agree(made, kept, table):
    if table == "work_precision":
        made, kept = [[sum(map(D, values))] for values in (made, kept)]
        return same(made[0], kept[0])
    return all(map(same, made, kept))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("table", choices=TABLES)
    parser.add_argument("--check", metavar="FILE")
    parser.add_argument("--every", type=int, default=1)
    options = parser.parse_args()
    header, rows = TABLES[options.table]
    rows = [(list(map(str, key)), make) for key, make in rows()]
    if options.check is None:
        print(header)
        for key, make in rows:
            print(",".join(key + make()), flush=True)
        return
    with open(options.check, encoding="utf-8") as file:
        lines = file.read().splitlines()
    if lines[0] != header or len(lines) != len(rows) + 1:
        sys.exit(f"{options.check}: another header or {len(lines) - 1} rows instead of {len(rows)}")
    for line, (key, make) in list(zip(lines[1:], rows))[:: options.every]:
        fields = line.split(",")
        made = make()
        if fields[: len(key)] != key or not agree(made, fields[len(key) :], options.table):
            sys.exit(f"{options.check} has {line}, made anew: {','.join(key + made)}")
    print(f"{options.check}: {len(rows[:: options.every])} of {len(rows)} rows made anew, all agree")


main()
