/// The routines of LAPACK that are called, as a Fortran compiler names them: arguments by address, matrices by columns,
/// the lengths of texts last.
#pragma once

#include <complex>
#include <cstddef>

extern "C" {
void dgeev_(const char* left, const char* right, const int* n, double* a, const int* rows, double* real, double* imag,
            double* vl, const int* vl_rows, double* vr, const int* vr_rows, double* work, const int* work_size,
            int* info, std::size_t, std::size_t);
void dsyev_(const char* vectors, const char* triangle, const int* n, double* a, const int* rows, double* values,
            double* work, const int* work_size, int* info, std::size_t, std::size_t);
void dgeqrf_(const int* rows, const int* columns, double* a, const int* a_rows, double* factors, double* work,
             const int* work_size, int* info);
void dorgqr_(const int* rows, const int* columns, const int* reflections, double* a, const int* a_rows,
             const double* factors, double* work, const int* work_size, int* info);
void dgesvd_(const char* left, const char* right, const int* rows, const int* columns, double* a, const int* a_rows,
             double* singular, double* u, const int* u_rows, double* v, const int* v_rows, double* work,
             const int* work_size, int* info, std::size_t, std::size_t);
void zgetrf_(const int* rows, const int* columns, std::complex<double>* a, const int* a_rows, int* pivots, int* info);
void zgetrs_(const char* transposed, const int* n, const int* right_sides, const std::complex<double>* a,
             const int* a_rows, const int* pivots, std::complex<double>* b, const int* b_rows, int* info, std::size_t);
void dgetrf_(const int* rows, const int* columns, double* a, const int* a_rows, int* pivots, int* info);
void dgetrs_(const char* transposed, const int* n, const int* right_sides, const double* a, const int* a_rows,
             const int* pivots, double* b, const int* b_rows, int* info, std::size_t);
void dgetc2_(const int* n, double* a, const int* a_rows, int* row_pivots, int* column_pivots, int* info);
void dgelsy_(const int* rows, const int* columns, const int* right_sides, double* a, const int* a_rows, double* b,
             const int* b_rows, int* order, const double* condition, int* rank, double* work, const int* work_size,
             int* info);
void zgesvd_(const char* left, const char* right, const int* rows, const int* columns, std::complex<double>* a,
             const int* a_rows, double* singular, std::complex<double>* u, const int* u_rows, std::complex<double>* v,
             const int* v_rows, std::complex<double>* work, const int* work_size, double* real_work, int* info,
             std::size_t, std::size_t);
}
