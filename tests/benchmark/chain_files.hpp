/// The problems of these tables as files for the program: plugin, constants, starting data.
#pragma once

#include <filesystem>
#include <string>

#include "orbit/orbit.hpp"

namespace tchat::benchmark {

/// The plugin of the chain with n states.
std::string chain_source(int n);

/// Writes chain.cpp, gc.chain and chain.dat for an orbit of the oscillator or of the chain, and `points` points of its
/// branch in alpha.
void write_chain_files(const std::filesystem::path& folder, const Orbit& x, int points);

/// The executable: what TCHAT_EXECUTABLE names, or the one that was built with this program.
std::string tchat_executable();

}  // namespace tchat::benchmark
