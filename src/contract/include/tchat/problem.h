/* The binary interface between tchat and a problem plugin, for any language that can fill a C struct.
 *
 * A plugin is a shared library that exports
 *
 *     const tchat_problem* tchat_problem_table(void);
 *
 * The table and everything it points to live as long as the library is loaded and never change. C++ authors do not
 * write this table: they include <tchat/problem.hpp>.
 *
 * A problem is three families of smooth functions, numbered from 1:
 *     fields f_i(x, p) in R^n,   events h_j(x, p) in R (the system lives in h >= 0),   jumps g_k(x, p) in R^n.
 *
 * Shapes. x has `dimension` entries. par has at least TCHAT_PAR_LENGTH entries, more where `parameters` needs them:
 * par[k-1] is PAR(k). The first `parameters` are the problem's own. The segment durations are par[60], par[61], ..., or
 * follow the parameters where these are more than 60: TCHAT_FIRST_DURATION. Matrices are column-major.
 * A function of kind TCHAT_EVENT has 1 row, TCHAT_INTEGRAND `integral_conditions` rows, the others `dimension` rows.
 *
 * A function that cannot be evaluated at a point returns NaN there; tchat then shortens its step.
 */
#ifndef TCHAT_PROBLEM_H
#define TCHAT_PROBLEM_H

#include <stddef.h>
#include <stdint.h>

#define TCHAT_PROBLEM_ABI 2
#define TCHAT_PAR_LENGTH 512
/* The index k of par[k] = T_1 in a problem of `parameters` parameters. */
#define TCHAT_FIRST_DURATION(parameters) ((parameters) > 60 ? (parameters) : 60)
#define TCHAT_POINTS_OF_SET 4 /* of first_in_lanes */

#ifdef __cplusplus
extern "C" {
#endif

enum { TCHAT_FIELD = 0, TCHAT_EVENT = 1, TCHAT_JUMP = 2, TCHAT_INTEGRAND = 3 };

/* A sliding mode (Filippov): the field `field` is that on the surface h = 0 of event function `surface`, between the
 * fields `minus`, where h < 0, and `plus`, where h > 0. The event function `to_minus`, h_x f of `minus`, ends it where
 * the orbit leaves with `minus`; `to_plus`, -h_x f of `plus`, where it leaves with `plus`. All count from 1. */
typedef struct tchat_sliding {
  int32_t field;
  int32_t minus;
  int32_t plus;
  int32_t surface;
  int32_t to_minus;
  int32_t to_plus;
} tchat_sliding;

/* Chatter, infinitely many impacts in finite time, as one jump: impacts with the jump `impact` at event function
 * `event` in the field `field` may accumulate. Then the jump `limit` leads to contact, with the field `contact` until
 * event function `release`, and from there the jump `leave` back to `field`. Before an impact the event function
 * `margin` is zero where chatter becomes incomplete, and positive where it is complete, and `time`, if it is not 0, the
 * time that the further impacts take. All count from 1. */
typedef struct tchat_chatter {
  int32_t field;
  int32_t event;
  int32_t impact;
  int32_t contact;
  int32_t release;
  int32_t limit;
  int32_t margin;
  int32_t leave;
  int32_t time;
} tchat_chatter;

typedef struct tchat_problem {
  uint32_t abi_version; /* TCHAT_PROBLEM_ABI */
  uint32_t struct_size; /* sizeof(tchat_problem) */

  int32_t dimension;  /* n >= 1 */
  int32_t parameters; /* 0.. */
  int32_t fields;     /* number of fields, 1.. */
  int32_t events;     /* number of event functions, 1.. (0.. with boundary conditions) */
  int32_t jumps;      /* number of jump functions, 1.. (0.. with boundary conditions) */

  /* Highest order of exact derivatives that the table supplies: 0 (`value` only), 1 (`first` too), 2 (`second` too).
   * tchat replaces what is missing by central differences. */
  int32_t derivative_order;

  const char* name;                   /* never NULL */
  const char* const* state_names;     /* `dimension` strings or NULL; likewise below */
  const char* const* parameter_names; /* `parameters` strings or NULL */
  const char* const* field_names;
  const char* const* event_names;
  const char* const* jump_names;
  const double* initial_parameters; /* `parameters` values or NULL */
  const double* initial_state;      /* where simulations start: `dimension` values or NULL (all zero) */

  const void* self; /* handed back as first argument of every function below */

  /* out = F(x, par) */
  void (*value)(const void* self, int32_t kind, int32_t index, const double* x, const double* par, double* out);

  /* out = F, dx (rows x dimension) = dF/dx, dp (rows x active_count) = dF/dPAR(active[.]); active counts from 1. */
  void (*first)(const void* self, int32_t kind, int32_t index, const double* x, const double* par,
                const int32_t* active, int32_t active_count, double* out, double* dx, double* dp);

  /* The directional derivative D = F_x v + F_p w, with direction = (v, w) of length dimension + active_count, and its
   * own derivatives: out = D, dx = dD/dx, dp = dD/dPAR(active[.]). */
  void (*second)(const void* self, int32_t kind, int32_t index, const double* x, const double* par,
                 const int32_t* active, int32_t active_count, const double* direction, double* out, double* dx,
                 double* dp);

  /* Index jump function iota: writes at most `capacity` index vectors (i, j, k) that may follow the segment `from`,
   * three integers each, the one with priority first, and returns how many there are. x is the state at the end of that
   * segment, before the jump. from = (0, 0, 0) asks for those at the start of a simulation, where x is the start
   * itself; none: the problem leaves that to the user. A negative count: cannot be evaluated at x. NULL when the
   * problem does not say what follows what. */
  int32_t (*successors)(const void* self, const int32_t from[3], const double* x, const double* par, int32_t* to,
                        int32_t capacity);

  /* User functions (PVLS) of the state x_1(0), added to the output: `user_values` numbers. */
  int32_t user_values;
  const char* const* user_value_names; /* `user_values` strings or NULL */
  void (*user_value)(const void* self, const double* x, const double* par, double* out);

  /* Starting values of the durations: `durations` values, NaN for one that is not known. NULL
   * when the problem does not say. */
  int32_t durations;
  const double* initial_durations;

  /* Sets entries of `par` that are only output (AUTO's PVLS), called for each segment (from 1) with its end x_s(1) and
   * a copy of PAR. NULL when there are none. */
  void (*output_parameters)(const void* self, int32_t segment, const double* x, double* par);

  /* Boundary value problems (IPS = 4): `boundary_conditions` conditions, each zero, on the starts x_s(0) and ends
   * x_s(1) of `segments` segments (dimension x segments each) and par, in which par[TCHAT_FIRST_DURATION(parameters) +
   * s - 1] is T_s. 0 and NULL: none. */
  int32_t boundary_conditions;
  void (*boundary)(const void* self, int32_t segments, const double* starts, const double* ends, const double* par,
                   double* out);
  /* The same with derivatives, boundary_conditions rows each, by all starts and ends (dimension x segments columns) and
   * by PAR(active[.]), durations among them. NULL: tchat takes central differences. */
  void (*boundary_first)(const void* self, int32_t segments, const double* starts, const double* ends,
                         const double* par, const int32_t* active, int32_t active_count, double* out, double* dstarts,
                         double* dends, double* dp);
  /* Number of integral conditions: the integrals of the functions of kind TCHAT_INTEGRAND over time, index s on segment
   * s, added over all segments, are zero. They may depend on the durations in par. */
  int32_t integral_conditions;

  /* Which of the fields are those of sliding: `sliding_modes` modes. The functions themselves are `value`'s as all
   * others; this tells what they are, for the names of points where sliding begins and ends. 0 and NULL: none, or not
   * told. */
  int32_t sliding_modes;
  const tchat_sliding* sliding;

  /* `first` at `points` points for one par, the arrays x, out, dx and dp of the points one behind the other: a field at
   * the Gauss points of some mesh intervals, an event function at all nodes of a segment. NULL: tchat calls `first` for
   * each. */
  void (*first_at_points)(const void* self, int32_t kind, int32_t index, int32_t points, const double* x,
                          const double* par, const int32_t* active, int32_t active_count, double* out, double* dx,
                          double* dp);

  /* Second derivatives at `points` points for one par, where weighted sums of them are all that matters. At each point
   * there are `directions` directions: v_k (dimension) by the state, and the same q_k (active_count) at all points by
   * the parameters; for each direction there are weights w_k (rows), and after them more weights u (rows). out = D_k =
   * F_x v_k + F_p q_k, and gradient (dimension + active_count) that of u . F + the sum over k of w_k . D_k by x and by
   * PAR(active[.]). All but q and par are of the points, one behind the other. NULL: tchat calls `first` and `second`
   * for each. */
  void (*second_at_points)(const void* self, int32_t kind, int32_t index, int32_t points, int32_t directions,
                           const double* x, const double* par, const int32_t* active, int32_t active_count,
                           const double* v, const double* q, const double* weights, double* out, double* gradient);

  /* `first` at `sets` sets of TCHAT_POINTS_OF_SET = 4 points for one par. The points of a set are side by side: entry k
   * of x, out, dx or dp of the point l = 0..3 is number 4 k + l of the set's array; the sets stand one behind the
   * other. NULL: tchat calls `first_at_points`. */
  void (*first_in_lanes)(const void* self, int32_t kind, int32_t index, int32_t sets, const double* x,
                         const double* par, const int32_t* active, int32_t active_count, double* out, double* dx,
                         double* dp);

  /* Modes of different dimension: field i has the states 1..field_dimensions[i - 1], at most `dimension`; jump k leads
   * to a mode of jump_dimensions[k - 1] states. What x, out and direction have beyond is zero in other modes; a field
   * gives -x[a] there, a jump 0, and neither fields nor event functions depend on it. Both NULL: all have `dimension`.
   */
  const int32_t* field_dimensions;
  const int32_t* jump_dimensions;

  /* Third derivatives: F along states that depend on three numbers e_1, e_2, e_3 of which squares are left out, x = sum
   * of x_m e^m, where bit k - 1 of m = 0..7 says that e^m has the factor e_k. out_m are the coefficients of F, so that
   * out_7 is F_xxx x_1 x_2 x_4 + F_xx x_1 x_6 + F_xx x_2 x_5 + F_xx x_4 x_3 + F_x x_7. x_m (dimension) and out_m (rows)
   * stand one behind the other. NULL: tchat takes differences of `second`. */
  void (*third)(const void* self, int32_t kind, int32_t index, const double* x, const double* par, double* out);

  /* The same at `points` points for one par, the arrays x and out of the points one behind the other. NULL: tchat calls
   * `third` for each. */
  void (*third_at_points)(const void* self, int32_t kind, int32_t index, int32_t points, const double* x,
                          const double* par, double* out);

  /* Which functions are those of chatter: `chatter_modes` modes. The functions themselves are `value`'s, and what
   * follows what `successors` says; this tells what they are. 0 and NULL: none, or not told. */
  int32_t chatter_modes;
  const tchat_chatter* chatter;
} tchat_problem;

/* Size of the table before the conditions of boundary value problems were added: such a table has none. */
#define TCHAT_PROBLEM_FIRST_SIZE offsetof(tchat_problem, boundary_conditions)
/* And before it told of sliding modes. */
#define TCHAT_PROBLEM_SECOND_SIZE offsetof(tchat_problem, sliding_modes)
/* And before it could be asked for many points at once. */
#define TCHAT_PROBLEM_THIRD_SIZE offsetof(tchat_problem, first_at_points)
/* And before second derivatives could be asked for at many points. */
#define TCHAT_PROBLEM_FOURTH_SIZE offsetof(tchat_problem, second_at_points)
/* And before four points could be side by side. */
#define TCHAT_PROBLEM_FIFTH_SIZE offsetof(tchat_problem, first_in_lanes)
/* And before modes could differ in dimension. */
#define TCHAT_PROBLEM_SIXTH_SIZE offsetof(tchat_problem, field_dimensions)
/* And before it had third derivatives. */
#define TCHAT_PROBLEM_SEVENTH_SIZE offsetof(tchat_problem, third)
/* And before these could be asked for at many points. */
#define TCHAT_PROBLEM_EIGHTH_SIZE offsetof(tchat_problem, third_at_points)
/* And before it told of chatter. */
#define TCHAT_PROBLEM_NINTH_SIZE offsetof(tchat_problem, chatter_modes)

typedef const tchat_problem* (*tchat_problem_entry)(void);
#define TCHAT_PROBLEM_ENTRY "tchat_problem_table"

#ifdef __cplusplus
}
#endif

#endif
