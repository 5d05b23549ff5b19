/// A problem written as formulas, checked: every name stands for something, every state has its equation.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plugin/formula_file.hpp"

namespace tchat::formulas {

struct ProblemModel {
  struct Field {
    std::string name;
    std::vector<Expression> rates;  ///< one for each state that it has
  };
  struct Function {
    std::string name;
    Expression value;
  };
  struct Jump {
    std::string name;
    std::vector<std::pair<std::size_t, Expression>> values;  ///< of the states that change
    std::size_t states = 0;                                  ///< of the mode that it leads to
  };
  /// A sliding mode (tchat_sliding), numbers from 1: `field` and the events at its ends count behind `fields`,
  /// `events`.
  struct Slide {
    std::string name;
    std::array<std::string, 2> end_names;
    int field, minus, plus, surface, to_minus, to_plus;
  };
  /// A mode of contact after chatter (tchat::Chatter), numbers from 1: what it makes counts behind all others.
  struct Contact {
    std::string name, release_name, limit_name, margin_name, leave_name, time_name;
    int field, event, impact, contact, release, limit, margin, leave, time;
  };
  /// Which field follows at a surface, by a sliding mode (from 0).
  struct Following {
    std::size_t slide;
    int field;
  };
  /// Index vectors and parts of them count from 1; 0 stands for any.
  struct SuccessorRule {
    bool at_start = false;
    std::array<int, 3> from{};
    std::optional<Expression> condition;
    std::optional<Following> following;  ///< instead of a condition
    std::vector<std::array<int, 3>> next;
  };

  FormulaFile file;  ///< with its definitions and functions
  NameTable names;
  std::vector<double> parameter_values;
  std::vector<double> initial_state;  ///< empty: not given
  std::vector<Field> fields;
  std::vector<Function> events;
  std::vector<Slide> slides;
  std::vector<Jump> jumps;
  std::vector<Contact> contacts;
  std::vector<Function> user_values;
  std::vector<SuccessorRule> successors;
  std::vector<FormulaError> remarks;  ///< no mistakes, but things to know
};

/// Mistakes are collected; where there is one, the model is not to be used.
ProblemModel check_formulas(FormulaFile file, FormulaErrors& errors);

}  // namespace tchat::formulas
