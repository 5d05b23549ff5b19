#include "app/program.hpp"

int main(int argc, char** argv) { return tchat::run_program(argc, argv); }
