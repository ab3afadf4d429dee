/* SPDX-License-Identifier: BSD-3-Clause */
/* Creases that a small number of points can pay for. Every crease takes vertices along it and where it ends or turns;
 * where those are most of what is asked for, none are left for the surface between. */
#ifndef AQR_CREASE_BUDGET_H
#define AQR_CREASE_BUDGET_H

#include "feature_graph.h"

/* What a half-edge of the array is_crease may be. */
enum
{
  AQR_CREASE = 1,
  AQR_CREASE_LOCKED = 2 /* asked for by the caller: never given up */
};

/* What there is to decide by. */
typedef struct aqr_chain_cost
{
  double creases, boundary; /* points that chains take at least: those where they end or turn, a few on every loop */
  double bend;              /* what aqr_crease_bend() says; 0 where nobody had to ask */
} aqr_chain_cost;

/* The points of all chains. s: cut along its creases. */
aqr_status aqr_chains_measure(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, aqr_chain_cost* cost);

/* The part of all bending, in [0, 1], that is along creases: most of it, where the faces between them are flat. */
double aqr_crease_bend(const aqr_surface* s, const aqr_chains* chains);

/* Clears is_crease (3 * n_faces) along the creases that bend the surface least for the points they take, until half of
 * what the creases take above `budget` is gone; *given_up, the edges cleared. They are no seams of s any more, but the
 * points beside them stay split: chains may be built of s, nothing else. What is left may run on where creases met, and
 * take less, or end in the open: the caller measures again. */
aqr_status aqr_creases_give_up(
  aqr_context* c, aqr_surface* s, const aqr_chains* chains, double budget, uint8_t* is_crease, size_t* given_up);

#endif
