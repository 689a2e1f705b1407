// Explicit Runge-Kutta steps of order 8 with two error estimates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace stridor {

/// Coefficients of the method of order 8(5,3) of Dormand and Prince, as of DOP853: Hairer, Nørsett,
/// Wanner, Solving Ordinary Differential Equations I, 2nd ed., II.10.
struct Dop853 {
  static constexpr std::size_t num_stages = 12;
  static constexpr std::array<std::array<double, num_stages>, num_stages> a{{
      {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {5.26001519587677318785587544488e-2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2, 0.0, 0.0, 0.0, 0.0,
       0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {2.95875854768068491816892993775e-2, 0.0, 8.87627564304205475450678981324e-2, 0.0, 0.0, 0.0,
       0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {2.41365134159266685502369798665e-1, 0.0, -8.84549479328286085344864962717e-1,
       9.24834003261792003115737966543e-1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {3.7037037037037037037037037037e-2, 0.0, 0.0, 1.70828608729473871279604482173e-1,
       1.25467687566822425016691814123e-1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {3.7109375e-2, 0.0, 0.0, 1.70252211019544039314978060272e-1,
       6.02165389804559606850219397283e-2, -1.7578125e-2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {3.70920001185047927108779319836e-2, 0.0, 0.0, 1.70383925712239993810273719705e-1,
       1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2,
       8.27378916381402288758473766002e-3, 0.0, 0.0, 0.0, 0.0, 0.0},
      {6.24110958716075717114429577812e-1, 0.0, 0.0, -3.36089262944694129406857109825,
       -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e1,
       2.01540675504778934086186788979e1, -4.34898841810699588477366255144e1, 0.0, 0.0, 0.0, 0.0},
      {4.77662536438264365890433908527e-1, 0.0, 0.0, -2.48811461997166764192642586468,
       -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e1,
       1.52792336328824235832586722938e1, -3.32882109689848629194453265587e1,
       -2.03312017085086261358222928593e-2, 0.0, 0.0, 0.0},
      {-9.3714243008598732571704021658e-1, 0.0, 0.0, 5.18637242884406370830023853209,
       1.09143734899672957818505394654, -8.14978701074692612513997267357,
       -1.85200656599969598641566180701e1, 2.27394870993505042818970056734e1,
       2.49360555267965238987089396762, -3.0467644718982195003823669022, 0.0, 0.0},
      {2.27331014751653820792359768449, 0.0, 0.0, -1.05344954667372501984066689879e1,
       -2.00087205822486249909675718444, -1.79589318631187989172765950534e1,
       2.79488845294199600508499808837e1, -2.85899827713502369474065508674,
       -8.87285693353062954433549289258, 1.23605671757943030647266201528e1,
       6.43392746015763530355970484046e-1, 0.0},
  }};
  static constexpr std::array<double, num_stages> b{5.42937341165687622380535766363e-2,
                                                    0.0,
                                                    0.0,
                                                    0.0,
                                                    0.0,
                                                    4.45031289275240888144113950566,
                                                    1.89151789931450038304281599044,
                                                    -5.8012039600105847814672114227,
                                                    3.1116436695781989440891606237e-1,
                                                    -1.52160949662516078556178806805e-1,
                                                    2.01365400804030348374776537501e-1,
                                                    4.47106157277725905176885569043e-2};
  /// b less weights of order 3.
  static constexpr std::array<double, num_stages> third_order{
      5.42937341165687622380535766363e-2 - 0.244094488188976377952755905512,
      0.0,
      0.0,
      0.0,
      0.0,
      4.45031289275240888144113950566,
      1.89151789931450038304281599044,
      -5.8012039600105847814672114227,
      3.1116436695781989440891606237e-1 - 0.733846688281611857341361741547,
      -1.52160949662516078556178806805e-1,
      2.01365400804030348374776537501e-1,
      4.47106157277725905176885569043e-2 - 0.220588235294117647058823529412e-1};
  /// b less weights of order 5.
  static constexpr std::array<double, num_stages> fifth_order{0.1312004499419488073250102996e-1,
                                                              0.0,
                                                              0.0,
                                                              0.0,
                                                              0.0,
                                                              -0.1225156446376204440720569753e+1,
                                                              -0.4957589496572501915214079952,
                                                              0.1664377182454986536961530415e+1,
                                                              -0.3503288487499736816886487290,
                                                              0.3341791187130174790297318841,
                                                              0.8192320648511571246570742613e-1,
                                                              -0.2235530786388629525884427845e-1};
};

/// A step of an autonomous system ẏ = f(y) of N unknowns, of which the first `num_controlled` have
/// their error controlled.
template <std::size_t N, std::size_t num_controlled = N>
class RungeKuttaStep {
 public:
  using State = std::array<double, N>;

  /// Takes a step from `y` with slope `slope` there.
  /// @param f void(const State& y, State& slope)
  template <class F>
  void take(const State& y, const State& slope, double h, F&& f) {
    stages_[0] = slope;
    State at;
    for (std::size_t s = 1; s < Dop853::num_stages; ++s) {
      for (std::size_t i = 0; i < N; ++i) {
        double sum = 0.0;
        for (std::size_t r = 0; r < s; ++r) sum += Dop853::a[s][r] * stages_[r][i];
        at[i] = y[i] + h * sum;
      }
      f(at, stages_[s]);
    }
    for (std::size_t i = 0; i < N; ++i) {
      double sum = 0.0;
      for (std::size_t s = 0; s < Dop853::num_stages; ++s) sum += Dop853::b[s] * stages_[s][i];
      end_[i] = y[i] + h * sum;
    }
    h_ = h;
  }

  const State& end() const { return end_; }

  /// Estimate of the error over the allowed error: accept up to 1.
  /// @param scale allowed error of the unknowns under control
  double error(const std::array<double, num_controlled>& scale) const {
    double fifth = 0.0;
    double third = 0.0;
    for (std::size_t i = 0; i < num_controlled; ++i) {
      double e5 = 0.0;
      double e3 = 0.0;
      for (std::size_t s = 0; s < Dop853::num_stages; ++s) {
        e5 += Dop853::fifth_order[s] * stages_[s][i];
        e3 += Dop853::third_order[s] * stages_[s][i];
      }
      fifth += e5 * e5 / (scale[i] * scale[i]);
      third += e3 * e3 / (scale[i] * scale[i]);
    }
    const double sum = fifth + 0.01 * third;
    if (sum == 0.0) return 0.0;
    return std::abs(h_) * fifth / std::sqrt(sum * static_cast<double>(num_controlled));
  }

 private:
  std::array<State, Dop853::num_stages> stages_;
  State end_{};
  double h_ = 0.0;
};

/// Factor by which the step may change after an error of order 8.
inline double step_factor(double error) {
  constexpr double safety = 0.9;
  constexpr double least = 0.2;
  constexpr double most = 6.0;
  if (!(error < 1e300)) return least;
  if (error == 0.0) return most;
  return std::clamp(safety * std::pow(error, -1.0 / 8.0), least, most);
}

}  // namespace stridor
