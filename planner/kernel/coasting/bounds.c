/* Cheap lower bounds of a walk's duration. */
#include "coasting.h"

#define BLURRED 100       /* times the rate of nearly straight turns: slower turns are blurred by rounding */

/* Sets up the active set of a mask. */
void choose(const Problem *p, ActiveSet *on, unsigned mask)
{
    on->count = on->turns = on->bound_heading = on->shared = 0;
    on->slowest = INFINITY;
    for (int k = 0; k < p->trims; k++) {
        if (!((mask >> k) & 1)) continue;
        double rate = fabs(p->rate[k]);
        on->place[on->count++] = k;
        on->turns += rate > p->straight;
        if (rate > 0 && rate < on->slowest) on->slowest = rate;
    }
    on->place[on->count] = -1;
    on->slow = on->slowest <= p->straight;
    on->blurred = on->slowest <= BLURRED * p->hardly_bent;
}

/* Lower bound from the distance: all chords in line, at a common speed of approach. */
double least_time(const Problem *p, const ActiveSet *on, double distance)
{
    if (distance <= 0) return 0;
    double fastest = 0, reach = 0;
    for (int i = 0; i < on->count; i++) {
        double speed = p->speed[on->place[i]], rate = fabs(p->rate[on->place[i]]);
        fastest = greater(fastest, speed);
        reach += speed == 0 ? 0 : rate == 0 ? INFINITY : 2 * speed / rate;
    }
    if (!(reach >= distance)) return INFINITY;
    double low = 0, high = fastest, time = distance / fastest;
    for (int round = 0; round < 5; round++) {
        double u = 0.5 * (low + high), covered = 0, spent = 0;
        for (int i = 0; i < on->count; i++) {
            double speed = p->speed[on->place[i]], rate = fabs(p->rate[on->place[i]]);
            if (!(speed > u)) continue;
            if (rate == 0) { covered = INFINITY; break; }
            double half = acos(u / speed);
            covered += 2 * speed / rate * sin(half);
            spent += 2 * half / rate;
        }
        if (covered >= distance) low = u;
        else {
            high = u;
            time = greater(time, spent + (distance - covered) / u);
        }
    }
    return time;
}

/* Lower bound from the wanted heading, turned to the right or to the left. */
double time_to_turn(const Problem *p, const ActiveSet *on)
{
    if (!p->wants_heading) return 0;
    double right = off_turns(p->heading), tolerance = p->heading_tolerance + p->heading_slack, fastest = 0, slowest = 0;
    if (fabs(right) <= tolerance) return 0;
    if (right < 0) right += 2 * PI;
    for (int i = 0; i < on->count; i++) {
        fastest = greater(fastest, p->rate[on->place[i]]);
        slowest = lesser(slowest, p->rate[on->place[i]]);
    }
    double by_right = fastest > 0 ? (right - tolerance) / fastest : INFINITY;
    double by_left = slowest < 0 ? (2 * PI - right - tolerance) / -slowest : INFINITY;
    return lesser(by_right, by_left) * (1 - 1e-12);
}

/* Upper bound of the cosine of an angle plus anything between two turns: its series up to the eighth power. */
static double best_cosine(double angle, double low, double high)
{
    double half = 0.5 * (high - low);
    double beyond = fabs(off_turns(angle + 0.5 * (low + high))) - half;
    if (beyond <= 0) return 1.0;
    double x = beyond * beyond;
    return 1 - x * (1. / 2 - x * (1. / 24 - x * (1. / 720 - x / 40320)));
}

/* Whether the goal is out of reach: in one of several directions, with all headings that can be reached in the seconds
 * given, maneuvers and coasts together do not lead far enough. */
int out_of_reach(const Problem *p, const ActiveSet *on, double seconds)
{
    double low[MOST], high[MOST], now_low = 0, now_high = 0;
    cplx still = 0;
    unsigned mask = 0;
    for (int i = 0; i < on->count; i++) mask |= 1u << on->place[i];
    for (int k = 0; k < p->trims; k++) {
        still += p->D[k];
        low[k] = now_low;
        high[k] = now_high;
        if (!((mask >> k) & 1)) continue;
        now_high = greater(now_high, p->rate[k] * seconds);
        now_low = lesser(now_low, p->rate[k] * seconds);
    }
    double toward = carg(p->goal - still), there = cabs(p->goal), bearing = there > 0 ? carg(p->goal) : 0;
    static const double aside[] = {0, 0.5, -0.5, 1.1, -1.1, 1.8, -1.8};
    for (int way = 0; way < 7; way++) {
        double direction = toward + aside[way], fastest = 0;
        double wanted = there * cos(bearing - direction) - reach(p);
        for (int k = 0; k < p->trims; k++) {
            wanted -= p->size_D[k] * best_cosine(p->bearing_D[k] - direction, low[k], high[k]);
            if (!((mask >> k) & 1)) continue;
            double turn = p->rate[k] * seconds;
            double speed = p->speed[k]
                * best_cosine(p->bearing_W[k] - direction, lesser(low[k], turn), greater(high[k], turn));
            fastest = greater(fastest, speed);
        }
        if (wanted > fastest * seconds) return 1;
    }
    return 0;
}

/* Distance less the displacements of the maneuvers. */
double to_cover(const Problem *p)
{
    double distance = cabs(p->goal) - reach(p);
    for (int k = 0; k < p->trims; k++) distance -= p->size_D[k];
    return distance;
}
