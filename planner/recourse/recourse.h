/* Value iteration for the stochastic shortest path: its numbers, and what is public. */
#ifndef RECOURSE_H
#define RECOURSE_H

#include <math.h>

#define PUBLIC __attribute__((visibility("default"))) /* called from Python; everything else is hidden */

#define RATIO 3           /* steps of one grid that are one of the next */
#define MOST_ACTIONS 64   /* of one trim */

static inline double greater(double a, double b) { return a > b ? a : b; }

/* Values of nodes inside the tolerance, where a flight has ended, are below 0. */
typedef struct {
    const float *value;             /* trims x levels x side x side, s */
    const unsigned char *ends;      /* whether a flight in each trim ends inside the tolerance */
    double step, tolerance;         /* m */
    double best_speed;              /* m/s, beyond the edge */
    int half, levels, outer;        /* steps to the edge of every grid and of what is used of the last one */
} Table;

/* Actions by the trim they begin in; outcomes of an action stand together, and so do the points of their paths. */
typedef struct {
    const int *first;               /* of each trim, and one past the last */
    const int *to;                  /* trim that each action ends in */
    const int *outcome;             /* first of each action, and one past the last */
    const int *points;              /* on the path of each outcome of an action; 0 where passing does not count */
    const int *path;                /* first point of each action */
    const int *coarsest;            /* grid on which each action is considered */
    const double *mean;             /* s, of each action */
    const double *circle;           /* forward, side and radius in m around all paths of an action */
    const double *duration;         /* s, of each outcome */
    const double *displacement;     /* forward, side, cosine, sine */
    const double *position;         /* forward, side of each point */
} Actions;

extern const double NO_SHIFT[5];

int level_of(const Table *table, double x, double y);
double look_up(const Table *table, int trim, double x, double y);
double action_cost(const Table *table, const Actions *actions, int action, const double *shift, double x, double y);

#endif
