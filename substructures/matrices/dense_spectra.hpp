// Eigenvalues, singular values and exponentials of dense matrices that several sources use, as
// explicit instantiations: their templates take most of a compilation, so they are compiled once,
// in dense_spectra.cpp.
//
// The precompiled headers hold this file and no source includes it: one that is compiled without
// them instantiates the same functions itself.
#pragma once

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

#ifndef STRIDOR_TEMPLATE
#define STRIDOR_TEMPLATE extern
#endif

namespace Eigen {
STRIDOR_TEMPLATE template SelfAdjointEigenSolver<MatrixXd>&
SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
STRIDOR_TEMPLATE template SelfAdjointEigenSolver<MatrixXcd>&
SelfAdjointEigenSolver<MatrixXcd>::compute(const EigenBase<MatrixXcd>&, int);
STRIDOR_TEMPLATE template SelfAdjointEigenSolver<Matrix2d>&
SelfAdjointEigenSolver<Matrix2d>::compute(const EigenBase<Matrix2d>&, int);
STRIDOR_TEMPLATE template GeneralizedSelfAdjointEigenSolver<MatrixXd>&
GeneralizedSelfAdjointEigenSolver<MatrixXd>::compute(const MatrixXd&, const MatrixXd&, int);
STRIDOR_TEMPLATE template GeneralizedSelfAdjointEigenSolver<Matrix2d>&
GeneralizedSelfAdjointEigenSolver<Matrix2d>::compute(const Matrix2d&, const Matrix2d&, int);
STRIDOR_TEMPLATE template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, bool);
STRIDOR_TEMPLATE template JacobiSVD<MatrixXcd>& JacobiSVD<MatrixXcd>::compute(const MatrixXcd&,
                                                                              unsigned int);

STRIDOR_TEMPLATE template void internal::matrix_exp_compute(const MatrixXd&, MatrixXd&,
                                                            internal::true_type);

}  // namespace Eigen
