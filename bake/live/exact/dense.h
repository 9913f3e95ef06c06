// This file holds small dense matrices, row by row, as the exact evaluator needs them (about 100 x 100).
//
// Products run along rows, so that compilers vectorise them without reordering a sum.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace sunbeam {

using Vector = std::vector<double>;

class Matrix {
 public:
  Matrix() = default;
  explicit Matrix(int size) : Matrix(size, size) {}
  Matrix(int rows, int columns)
      : rows_(rows), columns_(columns), values_(static_cast<std::size_t>(rows) * columns) {}

  int size() const { return rows_; }  // rows; of a square matrix also columns
  int columns() const { return columns_; }
  double* row(int i) { return values_.data() + static_cast<std::size_t>(i) * columns_; }
  const double* row(int i) const { return values_.data() + static_cast<std::size_t>(i) * columns_; }

 private:
  int rows_ = 0, columns_ = 0;
  Vector values_;
};

// Does y += factor * x over `count` numbers.
inline void add_scaled(double factor, const double* x, int count, double* y) {
  for (int k = 0; k < count; ++k) y[k] += factor * x[k];
}

inline double dot(const Vector& a, const Vector& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// Returns x^T a; for a symmetric matrix it is also a x.
inline Vector multiply(const Vector& x, const Matrix& a) {
  Vector y(a.columns());
  for (int i = 0; i < a.size(); ++i)
    if (x[i] != 0) add_scaled(x[i], a.row(i), a.columns(), y.data());
  return y;
}

inline Matrix multiply(const Matrix& a, const Matrix& b) {
  const int columns = b.columns();
  Matrix c(a.size(), columns);
  for (int i = 0; i < a.size(); ++i) {
    double* __restrict y = c.row(i);
    int k = 0;
    // Four terms for each time a sum is fetched and put back.
    for (; k + 4 <= a.columns(); k += 4) {
      const double f0 = a.row(i)[k], f1 = a.row(i)[k + 1], f2 = a.row(i)[k + 2], f3 = a.row(i)[k + 3];
      const double *x0 = b.row(k), *x1 = b.row(k + 1), *x2 = b.row(k + 2), *x3 = b.row(k + 3);
      for (int j = 0; j < columns; ++j) y[j] = y[j] + f0 * x0[j] + f1 * x1[j] + f2 * x2[j] + f3 * x3[j];
    }
    for (; k < a.columns(); ++k) add_scaled(a.row(i)[k], b.row(k), columns, y);
  }
  return c;
}

// Returns 1 - a.
inline Matrix one_minus(Matrix a) {
  for (int i = 0; i < a.size(); ++i) {
    for (int j = 0; j < a.size(); ++j) a.row(i)[j] = -a.row(i)[j];
    a.row(i)[i] += 1;
  }
  return a;
}

inline Matrix transposed(const Matrix& a) {
  Matrix t(a.columns(), a.size());
  for (int i = 0; i < a.size(); ++i)
    for (int j = 0; j < a.columns(); ++j) t.row(j)[i] = a.row(i)[j];
  return t;
}

// Replaces a by (a + a^T) / 2.
inline void symmetrise(Matrix& a) {
  for (int i = 0; i < a.size(); ++i)
    for (int k = 0; k < i; ++k) a.row(i)[k] = a.row(k)[i] = (a.row(i)[k] + a.row(k)[i]) / 2;
}

// Returns x with a x = b by Gauss elimination with row pivoting.
inline Matrix solve(Matrix a, Matrix b) {
  const int n = a.size(), columns = b.columns();
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(a.row(i)[k]) > std::abs(a.row(pivot)[k])) pivot = i;
    std::swap_ranges(a.row(k), a.row(k) + (pivot == k ? 0 : n), a.row(pivot));
    std::swap_ranges(b.row(k), b.row(k) + (pivot == k ? 0 : columns), b.row(pivot));
    for (int i = k + 1; i < n; ++i) {
      const double factor = -a.row(i)[k] / a.row(k)[k];
      if (factor == 0) continue;
      add_scaled(factor, a.row(k) + k, n - k, a.row(i) + k);
      add_scaled(factor, b.row(k), columns, b.row(i));
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int i = k + 1; i < n; ++i) add_scaled(-a.row(k)[i], b.row(i), columns, b.row(k));
    for (int j = 0; j < columns; ++j) b.row(k)[j] /= a.row(k)[k];
  }
  return b;
}

}  // namespace sunbeam
