/// P' (2.71-2.79): a section through a grazing point that is not P.
#pragma once

namespace tchat {

/// The level of an event function, or of one state, through x*. It is crossed by the flow, in either direction.
struct CrossSection {
  int event = 0;  ///< from 1; 0: the hyperplane of a constant state
  int state = 0;  ///< from 1, where event = 0
};

}  // namespace tchat
