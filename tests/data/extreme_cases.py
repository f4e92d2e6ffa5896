"""Makes extreme_cases.csv: references of the extreme cases in extended precision.

    python3 extreme_cases.py [case ...] > extreme_cases.csv        needs mpmath

Nothing here follows the program that is tested. Eigenvalues: K + s ZZ' and M + m ZZ' are summed plainly at 120 or 700
digits, and the inertia of K - l M is bisected on log10(l). Bars of 1e6 elements: Chebyshev polynomials of the
difference equation, 100 digits. Time stepping: the textbook formulas at 120 digits. Inputs are the f64 that the
decimal text means.
"""

import sys

from mpmath import acos, acosh, cos, inf, log, mp, mpf, pi, sin, sinh, sqrt, tan, tanh

FREE, FIXED, WALL = "free", "fixed", "wall"
RATIOS = ["1", "2", "inf"]


def number(text):
    """The f64 that the text means, exactly."""
    return mpf(float(text))


def bar(elements, length=None, modulus="1", density="1", area="1"):
    length = number(length if length is not None else str(elements))
    return dict(n=elements, h=length / elements, E=number(modulus), rho=number(density), A=number(area))


def omega_e2(b, gamma):
    return 12 / (1 + 2 * gamma) * b["E"] / (b["rho"] * b["h"] ** 2)


# ---- largest eigenvalue by inertia -------------------------------------------------------------------------------


def assemble(bars, left, right, gamma, beta_s, ratio):
    """Diagonals and off-diagonals of K + K_p and M + M_p."""
    kd, ko, md, mo, firsts, lasts = [], [], [], [], [], []
    for b in bars:
        k, m = b["E"] * b["A"] / b["h"], b["rho"] * b["A"] * b["h"] / 6
        firsts.append(len(kd))
        n = b["n"]
        kd += [k if j in (0, n) else 2 * k for j in range(n + 1)]
        md += [(2 + gamma) * m if j in (0, n) else 2 * (2 + gamma) * m for j in range(n + 1)]
        ko += [-k] * n + [mpf(0)]
        mo += [(1 - gamma) * m] * n + [mpf(0)]
        lasts.append(len(kd) - 1)
    ko, mo = ko[:-1], mo[:-1]

    def penalty(touching):
        s = beta_s * min(b["E"] * b["A"] / b["h"] for b in touching)
        return s, (mpf(0) if ratio == inf else s / (ratio * max(omega_e2(b, gamma) for b in touching)))

    for i in range(len(bars) - 1):
        s, m = penalty(bars[i : i + 2])
        for d, o, x in ((kd, ko, s), (md, mo, m)):
            d[lasts[i]] += x
            d[firsts[i + 1]] += x
            o[lasts[i]] -= x
    for end, node, b in ((left, 0, bars[0]), (right, -1, bars[-1])):
        if end == WALL:
            s, m = penalty([b])
            kd[node] += s
            md[node] += m
    low, high = int(left == FIXED), len(kd) - int(right == FIXED)
    return kd[low:high], ko[low : high - 1], md[low:high], mo[low : high - 1]


def is_above(matrices, l):
    """Whether K - l M is negative definite."""
    kd, ko, md, mo = matrices
    pivot = kd[0] - l * md[0]
    for i in range(1, len(kd)):
        if pivot >= 0:
            return False
        off = ko[i - 1] - l * mo[i - 1]
        pivot = kd[i] - l * md[i] - off * off / pivot
    return pivot < 0


def largest(bars, left, right, gamma, beta_s, ratio):
    matrices = assemble(bars, left, right, gamma, beta_s, ratio)
    low, high = mpf(-700), mpf(700)
    while high - low > mpf(10) ** -45:
        middle = (low + high) / 2
        if is_above(matrices, mpf(10) ** middle):
            high = middle
        else:
            low = middle
    return mpf(10) ** high


def largest_of_long_bar(n, far, gamma, beta_s, ratio, share=1):
    """l_max of a bar with E = rho = A = h = 1 on a wall, l > that of the bar with its contact node held.

    With c = (1 - a l)/(1 + b l) the rows read u_{j+1} + u_{j-1} = 2 c u_j, so u_j = T_j(c) from a free end and
    U_{j-1}(c) from a fixed one; the last row is (1 + b l)(c u_n - u_{n-1}) + (s - l m) u_n = 0."""
    a, b = (2 + gamma) / 6, (1 - gamma) / 6
    s = share * beta_s
    top = 12 / (1 + 2 * gamma)
    m = mpf(0) if ratio == inf else s / (ratio * top)

    def pivot(l):
        c = -(1 - a * l) / (1 + b * l)
        if c >= 1:
            t = acosh(c)
            q = sinh(t) * (tanh(n * t) if far == FREE else 1 / tanh(n * t))
        else:
            t = acos(c)
            q = sin(t) * (-tan(n * t) if far == FREE else 1 / tan(n * t))
        return s - l * m - (1 + b * l) * q

    # n t = pi/2 (far end free) or pi: the pole.
    c = cos(pi / (2 * n) if far == FREE else pi / n)
    low, high = (1 + c) / (a - b * c), top + s * 4 * (2 + gamma)
    while high - low > low * mpf(10) ** -60:
        middle = (low + high) / 2
        if pivot(middle) < 0:
            high = middle
        else:
            low = middle
    return high


# ---- time stepping -----------------------------------------------------------------------------------------------


def solve(diagonal, off, right):
    """x of the tridiagonal system, by elimination."""
    d, x = list(diagonal), list(right)
    for i in range(1, len(d)):
        f = off[i - 1] / d[i - 1]
        d[i] -= f * off[i - 1]
        x[i] -= f * x[i - 1]
    x[-1] /= d[-1]
    for i in range(len(d) - 2, -1, -1):
        x[i] = (x[i] - off[i] * x[i + 1]) / d[i]
    return x


def step_bar(scheme, n, gamma, beta_s, distance, velocity, steps):
    """Force and gap after `steps` steps at C = 1/2, r = 1, theta = 1/2 of n unit elements before a wall."""
    kd, ko, md, mo = assemble([bar(n)], FREE, FREE, gamma, mpf(0), mpf(1))
    s, m = beta_s, beta_s * (1 + 2 * gamma) / 12
    far = sqrt((1 + 2 * gamma) / 3)
    dt = far / 2
    loaded = md[:-1] + [md[-1] + m]

    def internal(u):
        f = [-k * x for k, x in zip(kd, u)]
        for i, k in enumerate(ko):
            f[i] -= k * u[i + 1]
            f[i + 1] -= k * u[i]
        return f

    def at_contact(x):
        return [mpf(0)] * n + [x]

    def gap_of(u):
        return u[-1] - distance

    def correction(gap):
        """(M + M_p)^-1 of the contact force on the predictor, and the reaction M applied to it."""
        a = solve(loaded, mo, at_contact(-s * max(gap, 0)))
        inertia = md[-1] * a[-1] + mo[-1] * a[-2]
        return a, -inertia

    u, v = [mpf(0)] * (n + 1), [velocity] * (n + 1)
    if scheme == "central-difference":

        def acceleration():
            gap = gap_of(u)
            f = internal(u)
            if gap <= 0:
                return solve(md, mo, f), mpf(0)
            f[-1] -= s * gap
            a = solve(loaded, mo, f)
            return a, s * gap + m * a[-1]

        a, force = acceleration()
        v = [x - dt / 2 * y for x, y in zip(v, a)]
        for _ in range(steps):
            v = [x + dt * y for x, y in zip(v, a)]
            u = [x + dt * y for x, y in zip(u, v)]
            a, force = acceleration()
        return force, gap_of(u)
    if scheme == "predictor-corrector":
        force = mpf(0)
        for _ in range(steps):
            a = solve(md, mo, internal(u))
            predicted = [x + dt * (y + dt * z) for x, y, z in zip(u, v, a)]
            c, force = correction(gap_of(predicted))
            v = [y + dt * (z + w) for y, z, w in zip(v, a, c)]
            u = [x + dt * y for x, y in zip(u, v)]
        return force, gap_of(u)
    alpha, theta = dt / far, mpf(1) / 2
    b1, b2 = alpha / 6 * (1 + 3 * alpha - alpha**2), alpha / 6 * (alpha**2 - 1)
    c, force = correction(gap_of(u))
    a = [x + y for x, y in zip(solve(md, mo, internal(u)), c)]
    for _ in range(steps):
        ahead = [x + far * y + far**2 / 2 * z for x, y, z in zip(u, v, a)]
        a_fs = solve(md, mo, internal(ahead))
        pulled = [x + alpha * far * y + far**2 * (b1 * z + b2 * w) for x, y, z, w in zip(u, v, a, a_fs)]
        pushed = [x + dt * y + dt**2 / 2 * z for x, y, z in zip(u, v, a)]
        u = [theta * x + (1 - theta) * y for x, y in zip(pulled, pushed)]
        a_pred = solve(md, mo, internal(u))
        v = [y + dt / 2 * (z + w) for y, z, w in zip(v, a, a_pred)]
        c, force = correction(gap_of(u))
        v = [y + dt / 2 * z for y, z in zip(v, c)]
        a = [x + y for x, y in zip(a_pred, c)]
    return force, gap_of(u)


def top_mode(courant, steps):
    """The top mode from u = 0 at unit velocity: v_j = cos((j - 1/2) t)/cos(t/2) after j steps, cos t = 1 - 2 C^2. Below
    the limit the largest |v_j|, above it ln |v_steps|."""
    lead = -mpf(1) / 2
    if courant > 1:
        rise = acosh(2 * courant**2 - 1)
        return log(sinh((steps + lead) * rise) / sinh(rise / 2))
    angle = acos(1 - 2 * courant**2)
    lag = pi - angle
    # |cos((j + lead) t)| is a sine of (j + lead) lag: the largest lies next to a crest.
    candidates = set()
    for crest in range(1, int(steps * lag / pi) * 2 + 2):
        j = int(crest * pi / 2 / lag - lead)
        candidates.update(i for i in range(j - 2, j + 4) if 0 <= i <= steps)
    return max(abs(cos((j + lead) * angle)) for j in candidates) / cos(angle / 2)


# ---- the cases ---------------------------------------------------------------------------------------------------

CASES = []


def spectrum(name, bars, left, right, gamma, beta_s, ratio, quantity="critical Courant number", digits=700):
    def value():
        mp.dps = digits
        made = [bar(**b) for b in bars]
        g = number(gamma)
        l = largest(made, left, right, g, number(beta_s), number(ratio))
        touching = [b for i, b in enumerate(made) if len(made) > 1 or WALL in (left, right)]
        rate = max(omega_e2(b, g) for b in touching) * (1 + 2 * g) / 12
        return {
            "critical Courant number": 2 * sqrt(rate / l),
            "omega_max": sqrt(l),
            "critical time step": 2 / sqrt(l),
        }[quantity]

    unit = {"critical Courant number": "1", "omega_max": "rad/s", "critical time step": "s"}[quantity]
    CASES.append((name, quantity, unit, value))


def on_wall(name, elements, gamma, beta_s, ratio, far=FREE, **properties):
    spectrum(name, [dict(elements=elements, **properties)], far, WALL, gamma, beta_s, ratio)


def pair(name, first, second, gamma, beta_s, ratio):
    spectrum(name, [first, second], FREE, FREE, gamma, beta_s, ratio)


def long_bar(name, far, ratio, share=1):
    def value():
        mp.dps = 100
        l = largest_of_long_bar(10**6, far, mpf(0), mpf(10), number(ratio), share)
        if share == 2:
            l = max(l, mpf(12))  # the common motion of two free bars does not feel the contact
        return 2 / sqrt(l)

    CASES.append((name, "critical Courant number", "1", value))


def stepped(name, scheme, gamma, beta_s, distance, velocity, steps=12):
    def value(which):
        def compute():
            mp.dps = 120
            return step_bar(scheme, 8, number(gamma), number(beta_s), number(distance), number(velocity), steps)[which]

        return compute

    CASES.append((name, "contact force", "N", value(0)))
    CASES.append((name, "gap", "m", value(1)))


def at_the_limit(name, courant):
    def value():
        mp.dps = 60
        return top_mode(number(courant), 10**6)

    quantity = "ln of the growth" if float(courant) > 1 else "largest amplitude"
    CASES.append((name, quantity, "1", value))


def list_spectra():
    for beta_s in ["1e-300", "1e-12", "1e12", "1e16", "1e300"]:
        for r in RATIOS:
            on_wall(f"beta-s-{beta_s}-r-{r}", 3, "0.5", beta_s, r)
    for r in ["1e-12", "0.999999999999999", "1.000000000000001", "1e12", "inf"]:
        for beta_s in ["1", "1e8"]:
            on_wall(f"ratio-{r}-beta-s-{beta_s}", 3, "1", beta_s, r)
    for gamma in ["0", "1e-16", "1"]:
        for r in RATIOS:
            on_wall(f"gamma-{gamma}-r-{r}", 3, gamma, "10", r)
    for n in [1, 2, 10**6]:
        for r in ["0.5", *RATIOS]:
            for far in [FREE, FIXED]:
                name = f"elements-{n}-{far}-r-{r}"
                long_bar(name, far, r) if n > 2 else on_wall(name, n, "0", "10", r, far)
            name = f"pair-elements-{n}-r-{r}"
            long_bar(name, FREE, r, 2) if n > 2 else pair(name, dict(elements=n), dict(elements=n), "0", "10", r)
    for factor in ["1e12", "1e-12"]:
        for r in RATIOS:
            unit = dict(elements=2)
            size = dict(elements=3, length=str(3 * float(factor)))
            pair(f"size-contrast-{factor}-r-{r}", unit, size, "0", "10", r)
            pair(f"density-contrast-{factor}-r-{r}", unit, dict(elements=3, density=factor), "0", "10", r)
            pair(f"area-contrast-{factor}-r-{r}", unit, dict(elements=3, area=factor), "0", "10", r)
    for name, modulus, density in [
        ("stiff-and-light", "1e145", "1e-145"),
        ("soft-and-heavy", "1e-144", "1e145"),
        ("largest-stiffness-and-mass", "1e289", "1e289"),
        ("smallest-stiffness-and-mass", "1e-289", "1e-289"),
    ]:
        for r in RATIOS:
            data = [dict(elements=3, modulus=modulus, density=density)]
            spectrum(f"{name}-r-{r}", data, FREE, WALL, "1", "10", r, "omega_max")
    for r in ["0.5", *RATIOS]:
        light = dict(elements=1, density="1e-200")
        pair(f"massless-contact-node-r-{r}", dict(elements=3), light, "1", "10", r)
        light = dict(elements=1, modulus="1e-200", density="1e-200")
        pair(f"weightless-bar-r-{r}", dict(elements=3), light, "1", "10", r)
        close = dict(elements=3, modulus="1.0000000000000002")
        pair(f"modulus-one-bit-off-r-{r}", dict(elements=3), close, "0", "10", r)
        close = dict(elements=3, density="1.0000000000000002")
        pair(f"density-one-bit-off-r-{r}", dict(elements=3), close, "0", "10", r)
    for r in ["1e-12", "0.5"]:
        for beta_s in ["10", "1e16"]:
            four = dict(elements=4)
            pair(f"top-mode-orthogonal-r-{r}-beta-s-{beta_s}", four, four, "0", beta_s, r)
    for name, striker, rod in [
        (
            "units-si",
            dict(elements=80, length="0.2", modulus="210e9", density="7850", area="4e-4"),
            dict(elements=300, length="1", modulus="70e9", density="2700", area="3e-4"),
        ),
        (
            "units-mm-tonne-s",
            dict(elements=80, length="200", modulus="210e3", density="7.85e-9", area="400"),
            dict(elements=300, length="1000", modulus="70e3", density="2.7e-9", area="300"),
        ),
    ]:
        for r in ["1", "inf"]:
            spectrum(f"{name}-r-{r}", [striker, rod], FREE, FREE, "1", "10", r, "critical time step", 120)


def list_steps():
    for scheme in ["central-difference", "predictor-corrector", "park"]:
        for gamma in ["0", "1"]:
            stepped(f"stiffest-contact-{scheme}-gamma-{gamma}", scheme, gamma, "1e16", "0", "0.1")
        stepped(f"grazing-contact-{scheme}", scheme, "1", "1e4", "1e-300", "1e-300")
        stepped(f"penetration-at-rest-{scheme}", scheme, "1", "1e4", "-1e-300", "0", 5)
        stepped(f"distance-at-rest-{scheme}", scheme, "1", "1e4", "1e-300", "0")
        for velocity in ["1e-150", "1e150"]:
            stepped(f"impact-at-{velocity}-{scheme}", scheme, "1", "1e4", "0", velocity)
    for courant in ["0.999999999", "1.000000001"]:
        for gamma in ["0", "1"]:
            at_the_limit(f"step-{courant}-central-difference-gamma-{gamma}", courant)
            at_the_limit(f"step-{courant}-predictor-corrector-gamma-{gamma}", courant)


def main(wanted):
    list_spectra()
    list_steps()
    print("case,quantity,unit,reference")
    for name, quantity, unit, value in CASES:
        if not wanted or name in wanted:
            text = mp.nstr(value(), 30, min_fixed=-5, max_fixed=5)
            print(f"{name},{quantity},{unit},{text}", flush=True)


main(sys.argv[1:])
