/* Bounds of a walk's seconds that cost little. */
#include "closed_forms.c"

static void choose(const Row *row, Active *on, unsigned mask)
{
    on->count = on->turns = 0;
    on->slowest = INFINITY;
    for (int k = 0; k < row->trims; k++) {
        if (!((mask >> k) & 1)) continue;
        double rate = fabs(row->rate[k]);
        on->place[on->count++] = k;
        on->turns += rate > row->straight;
        if (rate > 0 && rate < on->slowest) on->slowest = rate;
    }
    on->slow = on->slowest <= row->straight;
    on->blurred = on->slowest <= 100 * row->hardly_bent;
}

/* Least seconds in which the given trims cover a distance: all chords in line, the end nearing at one speed. */
static double least_time(const Row *row, const Active *on, double distance)
{
    if (distance <= 0) return 0;
    double fastest = 0, reach = 0;
    for (int i = 0; i < on->count; i++) {
        double speed = row->speed[on->place[i]], rate = fabs(row->rate[on->place[i]]);
        fastest = MAX(fastest, speed);
        reach += speed == 0 ? 0 : rate == 0 ? INFINITY : 2 * speed / rate;
    }
    if (!(reach >= distance)) return INFINITY;
    double low = 0, high = fastest, time = distance / fastest;
    for (int round = 0; round < 5; round++) {
        double u = 0.5 * (low + high), covered = 0, spent = 0;
        for (int i = 0; i < on->count; i++) {
            double speed = row->speed[on->place[i]], rate = fabs(row->rate[on->place[i]]);
            if (!(speed > u)) continue;
            if (rate == 0) { covered = INFINITY; break; }
            double half = acos(u / speed);
            covered += 2 * speed / rate * sin(half);
            spent += 2 * half / rate;
        }
        if (covered >= distance) low = u;
        else {
            high = u;
            time = MAX(time, spent + (distance - covered) / u);
        }
    }
    return time;
}

/* Least seconds in which the given trims turn to the wanted heading, by the right or by the left. */
static double least_turning(const Row *row, const Active *on)
{
    if (!row->wants_heading) return 0;
    double right = off_turns(row->heading), tolerance = MAX(row->heading_tolerance, 2e-7), fastest = 0, slowest = 0;
    if (fabs(right) <= tolerance) return 0;
    if (right < 0) right += 2 * M_PI;
    for (int i = 0; i < on->count; i++) {
        fastest = MAX(fastest, row->rate[on->place[i]]);
        slowest = MIN(slowest, row->rate[on->place[i]]);
    }
    double by_right = fastest > 0 ? (right - tolerance) / fastest : INFINITY;
    double by_left = slowest < 0 ? (2 * M_PI - right - tolerance) / -slowest : INFINITY;
    return MIN(by_right, by_left) * (1 - 1e-12);
}

/* No less than the largest cosine of an angle plus anything between two turns: by the series up to the eighth
 * power, which is nowhere below the cosine. */
static double best_cosine(double angle, double low, double high)
{
    double half = 0.5 * (high - low);
    if (half >= M_PI) return 1.0;
    double beyond = fabs(off_turns(angle + 0.5 * (low + high))) - half;
    if (beyond <= 0) return 1.0;
    double x = beyond * beyond;
    return 1 - x * (1. / 2 - x * (1. / 24 - x * (1. / 720 - x / 40320)));
}

/* Whether the goal is out of reach in the seconds given: in some direction, with the headings that can be
 * turned to in that time, neither the maneuvers nor the coasts lead far enough. */
static int out_of_reach(const Row *row, const Active *on, double seconds)
{
    double low[MOST], high[MOST], now_low = 0, now_high = 0;
    cplx still = 0;
    unsigned mask = 0;
    for (int i = 0; i < on->count; i++) mask |= 1u << on->place[i];
    for (int k = 0; k < row->trims; k++) {
        still += row->D[k];
        low[k] = now_low;
        high[k] = now_high;
        if (!((mask >> k) & 1)) continue;
        now_high = MAX(now_high, row->rate[k] * seconds);
        now_low = MIN(now_low, row->rate[k] * seconds);
    }
    double toward = carg(row->goal - still), there = cabs(row->goal), bearing = there > 0 ? carg(row->goal) : 0;
    static const double aside[] = {0, 0.5, -0.5, 1.1, -1.1, 1.8, -1.8};
    for (int way = 0; way < 7; way++) {
        double direction = toward + aside[way], fastest = 0;
        double wanted = there * cos(bearing - direction) - MAX(row->tolerance, 2e-7) - 1e-9;
        for (int k = 0; k < row->trims; k++) {
            wanted -= row->size_D[k] * best_cosine(row->bearing_D[k] - direction, low[k], high[k]);
            if (!((mask >> k) & 1)) continue;
            double turn = row->rate[k] * seconds;
            double speed = row->speed[k]
                * best_cosine(row->bearing_W[k] - direction, MIN(low[k], turn), MAX(high[k], turn));
            fastest = MAX(fastest, speed);
        }
        if (wanted > fastest * seconds) return 1;
    }
    return 0;
}

static double to_cover(const Row *row)
{
    double distance = cabs(row->goal) - MAX(row->tolerance, 2e-7);
    for (int k = 0; k < row->trims; k++) distance -= row->size_D[k];
    return distance;
}
