/// A ball on a table that moves by a limit cycle of radius Gamma; one bounce a period has closed forms.
#pragma once

namespace test_support {

inline constexpr const char* bouncing_ball = R"(par Gamma=1.3, r=0.5
init velocity=3, w=1.3
growth = 1 - (table^2 + w^2)/Gamma^2
height'   = velocity
velocity' = -1
table'    = growth*table + w
w'        = growth*w - table
event contact = height - table
jump impact: velocity -> -r*velocity + (1 + r)*w
after any: contact -> impact
)";

}  // namespace test_support
