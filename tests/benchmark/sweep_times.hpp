/// Table (k): `tchat sweep` beside a loop that a user may write by hand: Boost's odeint with dense output, arrays of
/// fixed size, the formulas in place, events by regula falsi. Both integrate the impact oscillator of problems/linosc
/// from the same state, value by value, with relative tolerance 1e-8, over as many events, of which the last hundred
/// count.
///
/// The loop tells nothing but its states. tchat also says what the motion is: it looks for repetition, and with
/// --lyapunov for exponents. Wherever the motion is periodic both must end in the same impact.
#pragma once

namespace tchat::benchmark {

/// `values` of the swept parameter; the middle one of `rounds` alternating runs counts.
void print_sweep_times(int values, int rounds);

}  // namespace tchat::benchmark
