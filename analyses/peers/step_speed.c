/* Plain loops for analyses/step_speed.rs: central differences of a uniform bar with free ends, lumped and consistent mass.
   Usage: step_speed lumped|consistent NODES STEPS REPEATS; prints the median node-steps per second and a check sum. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* h = E = rho = A = 1; c = dt k/m. */
static void lumped(int n, long steps, double dt, double *restrict u, double *restrict v) {
    const double c = dt;
    for (long step = 0; step < steps; step++) {
        v[0] += 2 * c * (u[1] - u[0]);
        for (int i = 1; i < n - 1; i++) v[i] += c * (u[i - 1] - 2 * u[i] + u[i + 1]);
        v[n - 1] += 2 * c * (u[n - 2] - u[n - 1]);
        for (int i = 0; i < n; i++) u[i] += dt * v[i];
    }
}

/* M = tridiag(1/6, 2/3, 1/6), 1/3 at the ends; l and d of its L D L'. */
static void consistent(int n, long steps, double dt, double *restrict u, double *restrict v, double *restrict x,
                       const double *restrict l, const double *restrict inverse) {
    for (long step = 0; step < steps; step++) {
        x[0] = u[1] - u[0];
        for (int i = 1; i < n - 1; i++) x[i] = u[i - 1] - 2 * u[i] + u[i + 1] - l[i] * x[i - 1];
        x[n - 1] = u[n - 2] - u[n - 1] - l[n - 1] * x[n - 2];
        x[n - 1] *= inverse[n - 1];
        for (int i = n - 2; i >= 0; i--) x[i] = x[i] * inverse[i] - l[i + 1] * x[i + 1];
        for (int i = 0; i < n; i++) {
            v[i] += dt * x[i];
            u[i] += dt * v[i];
        }
    }
}

int main(int argc, char **argv) {
    if (argc != 5) return 2;
    int n = atoi(argv[2]), repeats = atoi(argv[4]);
    long steps = atol(argv[3]);
    int is_lumped = !strcmp(argv[1], "lumped");
    double dt = is_lumped ? 0.5 : 0.25, sum = 0;
    double *u = calloc(n, sizeof *u), *v = calloc(n, sizeof *v), *x = calloc(n, sizeof *x);
    double *l = calloc(n, sizeof *l), *inverse = calloc(n, sizeof *inverse), *rate = calloc(repeats, sizeof *rate);
    double pivot = 1.0 / 3;
    inverse[0] = 1 / pivot;
    for (int i = 1; i < n; i++) {
        l[i] = (1.0 / 6) / pivot;
        pivot = (i == n - 1 ? 1.0 / 3 : 2.0 / 3) - l[i] * (1.0 / 6);
        inverse[i] = 1 / pivot;
    }
    for (int i = 0; i < n; i++) v[i] = 0.1 * ((i * 37) % 11 - 5);
    for (int k = 0; k < repeats; k++) {
        double start = now();
        if (is_lumped) lumped(n, steps, dt, u, v);
        else consistent(n, steps, dt, u, v, x, l, inverse);
        rate[k] = (double)n * steps / (now() - start);
    }
    for (int i = 0; i < n; i++) sum += u[i];
    qsort(rate, repeats, sizeof *rate, by_size);
    printf("%.6e %.3e\n", rate[repeats / 2], sum);
    return 0;
}
