// Factors of dense matrices that several sources use, as explicit instantiations: their templates
// take most of a compilation, so they are compiled once, in dense_factors.cpp.
//
// The precompiled headers hold this file and no source includes it: one that is compiled without
// them instantiates the same functions itself.
#pragma once

#include <Eigen/Dense>

#ifndef STRIDOR_TEMPLATE
#define STRIDOR_TEMPLATE extern
#endif

namespace Eigen {

STRIDOR_TEMPLATE template void PartialPivLU<MatrixXd>::compute();
STRIDOR_TEMPLATE template void PartialPivLU<MatrixXcd>::compute();
STRIDOR_TEMPLATE template double internal::rcond_invmatrix_L1_norm_estimate(
    const PartialPivLU<MatrixXd>&);
STRIDOR_TEMPLATE template double internal::rcond_invmatrix_L1_norm_estimate(
    const PartialPivLU<MatrixXcd>&);
STRIDOR_TEMPLATE template void FullPivLU<MatrixXd>::computeInPlace();
STRIDOR_TEMPLATE template void FullPivLU<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
STRIDOR_TEMPLATE template void ColPivHouseholderQR<MatrixXd>::computeInPlace();
STRIDOR_TEMPLATE template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&,
                                                                          VectorXd&) const;

STRIDOR_TEMPLATE template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
STRIDOR_TEMPLATE template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

STRIDOR_TEMPLATE template void TriangularViewImpl<const MatrixXd, UnitLower, Dense>::solveInPlace<
    OnTheLeft>(const MatrixBase<VectorXd>&) const;
STRIDOR_TEMPLATE template void TriangularViewImpl<const MatrixXd, UnitLower, Dense>::solveInPlace<
    OnTheLeft>(const MatrixBase<MatrixXd>&) const;
STRIDOR_TEMPLATE template void TriangularViewImpl<const MatrixXd, Upper, Dense>::solveInPlace<
    OnTheLeft>(const MatrixBase<VectorXd>&) const;
STRIDOR_TEMPLATE template void TriangularViewImpl<const MatrixXd, Upper, Dense>::solveInPlace<
    OnTheLeft>(const MatrixBase<MatrixXd>&) const;
STRIDOR_TEMPLATE template void TriangularViewImpl<const MatrixXd, Lower, Dense>::solveInPlace<
    OnTheLeft>(const MatrixBase<VectorXd>&) const;
STRIDOR_TEMPLATE template void TriangularViewImpl<const MatrixXd, Lower, Dense>::solveInPlace<
    OnTheLeft>(const MatrixBase<MatrixXd>&) const;
STRIDOR_TEMPLATE template void
TriangularViewImpl<const Transpose<const MatrixXd>, Upper, Dense>::solveInPlace<OnTheLeft>(
    const MatrixBase<VectorXd>&) const;
STRIDOR_TEMPLATE template void
TriangularViewImpl<const Transpose<const MatrixXd>, Upper, Dense>::solveInPlace<OnTheLeft>(
    const MatrixBase<MatrixXd>&) const;

}  // namespace Eigen
