/// Measuring on a machine that also does other things: the least or the middle one of many short measurements, and
/// clocks.
#pragma once

#include <chrono>
#include <vector>

namespace tchat::benchmark {

/// The middle one of a list of measurements; 0 when there are none.
double median(std::vector<double> values);

/// The least one; 0 when there are none.
double least(const std::vector<double>& values);

/// The slope of the straight line through (log size, log value) by least squares: value grows like size^slope.
double fitted_exponent(const std::vector<int>& sizes, const std::vector<double>& values);

/// Processor time that this process has used so far, in seconds. Reading it takes some tenths of a microsecond.
double processor_clock();

/// Processor time of one call, in seconds: not disturbed by other programs that take the processor in between.
template <class Work>
double processor_seconds(Work&& work) {
  const double begin = processor_clock();
  work();
  return processor_clock() - begin;
}

/// Wall-clock time of one call, in seconds: for work of a few microseconds.
template <class Work>
double seconds(Work&& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Makes the compiler believe that the value is used.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace tchat::benchmark
