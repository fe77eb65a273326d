// The program in C is a program in C++17, too.
#include "program.c"
