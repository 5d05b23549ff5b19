/// PAR(k) - v: points that the user asked for (UZR).
#pragma once

#include "stability/test_function.hpp"

namespace tchat {

class UserValueTest final : public TestFunction {
 public:
  /// `name` is the parameter's name for messages; `stop` ends the branch there.
  UserValueTest(int parameter, double wanted, bool stop, std::string name)
      : parameter_(parameter), wanted_(wanted), stop_(stop), parameter_name_(std::move(name)) {}

  std::string name() const override;
  TestValue evaluate(const TestedPoint& point) const override;
  SpecialPoint classify(const TestedPoint& point, bool rising) const override;

 private:
  int parameter_;
  double wanted_;
  bool stop_;
  std::string parameter_name_;
};

}  // namespace tchat
