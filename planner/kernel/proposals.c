/* Times that may be best: corrected, flown, and kept if they are. */
#include "times.c"

#define SETTLED 6 /* steps after which times that can settle have done so */

/* Keeps times that reach the goal faster than the best so far. */
static void keep(Row *row, double *times)
{
    double cost = row->fixed, turn;
    for (int k = 0; k < row->trims; k++) {
        if (!(times[k] >= -SMALL)) return;
        if (times[k] < 0) times[k] = 0;
        cost += times[k];
    }
    if (!(cost < row->best)) return;
    cplx end = motion(row, times, 0, &turn);
    if (!(cabs(end - row->goal) <= MAX(row->tolerance + INSIDE, 2e-7))) return;
    if (row->wants_heading
        && !(fabs(off_turns(turn - row->heading)) <= MAX(row->heading_tolerance + HEADING_INSIDE, 2e-7)))
        return;
    row->best = cost;
    memcpy(row->times, times, sizeof(double) * row->trims);
}

/* The least step (Gauss, Newton), again and again, to where the goal's disc, or the goal, and a bound heading are met.
 * Where two velocities of the end are parallel, or the goal is at the edge of reach, Newton's equations for a best
 * point are singular, though the guess may be good. Yaw rates are taken as shares of the fastest. */
static void settle(const Row *row, const Active *on, double *times)
{
    int n = on->count, ends = row->tolerance > 0 ? 1 : 2, rows = ends + on->bound_heading;
    double fastest = 0;
    for (int i = 0; i < n; i++) fastest = MAX(fastest, fabs(row->rate[on->place[i]]));
    for (int round = 0; round < SETTLED; round++) {
        cplx velocity[MOST];
        double turn, J[3][MOST], M[9], b[3];
        cplx miss = motion(row, times, velocity, &turn) - row->goal;
        double size = cabs(miss);
        cplx normal = size > 0 ? miss / size : 1;
        for (int i = 0; i < n; i++) {
            cplx v = velocity[on->place[i]];
            J[0][i] = ends == 1 ? dot(normal, v) : creal(v);
            J[1][i] = cimag(v);
            if (on->bound_heading) J[ends][i] = row->rate[on->place[i]] / fastest;
        }
        if (ends == 1) b[0] = row->tolerance - size;
        else { b[0] = -creal(miss); b[1] = -cimag(miss); }
        if (on->bound_heading) b[ends] = -off_turns(turn - on->target) / fastest;
        for (int i = 0; i < rows; i++)
            for (int j = 0; j < rows; j++) {
                M[i * rows + j] = 0;
                for (int k = 0; k < n; k++) M[i * rows + j] += J[i][k] * J[j][k];
            }
        if (!eliminate(M, b, rows)) return;
        for (int k = 0; k < n; k++)
            for (int i = 0; i < rows; i++) times[on->place[k]] += J[i][k] * b[i];
    }
}

static void propose(Row *row, const Active *on, const double *of_active, cplx m)
{
    double times[MOST] = {0}, cost = row->fixed, slack = MAX(1e-6, EXACT / on->slowest);
    if (on->slow || on->blurred) slack = 1;
    for (int i = 0; i < on->count; i++) {
        if (!(of_active[i] >= -slack)) return;
        times[on->place[i]] = of_active[i];
        cost += of_active[i];
    }
    if (!(cost < row->best + (on->slow || on->blurred ? 0.05 * cost : 10 * slack))) return;
    double guess[MOST];
    memcpy(guess, times, sizeof(guess));
    if (!newton(row, on, times, m)) {
        memcpy(times, guess, sizeof(guess));
        keep(row, guess);
        settle(row, on, times);
        keep(row, times);
        return;
    }
    double way = 0, tolerance = row->tolerance;
    for (int i = 0; i < on->count; i++) way += row->speed[on->place[i]] * times[on->place[i]];
    if (way > FAR && tolerance > 0) {
        /* The end is rounded in proportion to the way: so much further inside. */
        row->tolerance = MAX(0.5 * tolerance, tolerance - EXACT / 100 * way);
        newton(row, on, times, m);
        row->tolerance = tolerance;
    }
    keep(row, times);
}

/* Times of the active turns from the headings after them; straight times are given. */
static void times_of(const Row *row, const Active *on, const cplx *heading, const double *straight, double *times)
{
    cplx before = 1;
    for (int i = 0, j = 0; i < on->count; i++) {
        double rate = row->rate[on->place[i]];
        if (fabs(rate) <= row->straight) { times[i] = straight[on->place[i]]; continue; }
        cplx after = heading[++j];
        double angle = carg(after * conj(before)), time = angle / rate;
        if (time < 0 && fabs(angle) > (on->blurred ? BLUR : EXACT)) time += 2 * M_PI / fabs(rate);
        times[i] = time;
        before = after;
    }
}

static void from_headings(Row *row, const Active *on, const cplx *heading, const double *straight, cplx m)
{
    double times[MOST];
    times_of(row, on, heading, straight, times);
    propose(row, on, times, m);
}
