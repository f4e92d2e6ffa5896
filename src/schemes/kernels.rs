//! The loops over nodes. Slices of equal length, no bounds check inside, no fused multiply-add: the results are the
//! same bytes on every machine, whatever instruction set is chosen at run time.

/// The instruction set of the loops, chosen once when a stepper is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Instructions {
    /// What the build target guarantees.
    Baseline,
    /// Four lanes of f64.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Instructions {
    /// The widest set of this machine.
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            return Self::Avx2;
        }
        Self::Baseline
    }
}

/// Defines `$name` as the loop `$body`, compiled for every instruction set.
macro_rules! dispatched {
    ($(#[$doc:meta])* $name:ident = $body:ident($($argument:ident: $kind:ty),*)) => {
        $(#[$doc])*
        #[allow(unsafe_code)]
        pub(super) fn $name(set: Instructions, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($argument: $kind),*) {
                $body($($argument),*);
            }
            match set {
                Instructions::Baseline => $body($($argument),*),
                // SAFETY: `Avx2` is made by `Instructions::detect` alone, after it has found the feature.
                #[cfg(target_arch = "x86_64")]
                Instructions::Avx2 => unsafe { avx2($($argument),*) },
            }
        }
    };
}

pub(super) use dispatched;

/// (u_left - u) + (u_right - u): the difference form gives a rigid translation no force at all.
#[inline(always)]
fn second_difference(left: f64, here: f64, right: f64) -> f64 {
    (left - here) + (right - here)
}

/// v += c (second difference of u) + load, u += dt v, in one pass over a stretch of equal nodes. `u` has one node more on
/// the right; `left` is the displacement before the step of the node on the left, and that of the last node is returned.
///
/// In place: a loop that reads one array and writes another one takes up to twice as long where their addresses happen to
/// agree in the last twelve bits.
#[inline(always)]
pub(super) fn kick_drift(c: f64, load: f64, dt: f64, left: f64, u: &mut [f64], velocity: &mut [f64]) -> f64 {
    let n = velocity.len();
    let (u, mut left) = (&mut u[..=n], left);
    // The additions set the pace, so that a load of zero is worth leaving out.
    if load == 0.0 {
        for i in 0..n {
            let here = u[i];
            let v = velocity[i] + c * second_difference(left, here, u[i + 1]);
            velocity[i] = v;
            u[i] = here + dt * v;
            left = here;
        }
    } else {
        for i in 0..n {
            let here = u[i];
            let v = velocity[i] + (c * second_difference(left, here, u[i + 1]) + load);
            velocity[i] = v;
            u[i] = here + dt * v;
            left = here;
        }
    }
    left
}

#[inline(always)]
fn rate_loop(c: f64, load: f64, u: &[f64], rate: &mut [f64]) {
    let n = rate.len();
    let (left, here, right) = (&u[..n], &u[1..=n], &u[2..n + 2]);
    for i in 0..n {
        rate[i] = c * second_difference(left[i], here[i], right[i]) + load;
    }
}

#[inline(always)]
fn drift_loop(dt: f64, kick: &[f64], velocity: &mut [f64], u: &mut [f64]) {
    let n = u.len();
    let (kick, velocity) = (&kick[..n], &mut velocity[..n]);
    for i in 0..n {
        let v = velocity[i] + kick[i];
        velocity[i] = v;
        u[i] += dt * v;
    }
}

dispatched! {
    /// rate = c (second difference of u) + load; `u` has one node more on either side.
    uniform_rate = rate_loop(c: f64, load: f64, u: &[f64], rate: &mut [f64])
}

dispatched! {
    /// v += kick, u += dt v.
    drift = drift_loop(dt: f64, kick: &[f64], velocity: &mut [f64], u: &mut [f64])
}
