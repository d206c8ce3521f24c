// Each consumer's own rule, applied to the numbers of the file we wrote for it, gives noise; our
// fit of that noise has to return the coefficients that went into the file.

#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/export/imu_models.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using test::at_most;
using test::exported;
using test::known;
using test::number_after;

namespace {

constexpr double kRate = 200;
constexpr std::size_t kSamples = 100000;

// What a consumer does with its numbers, sample by sample.
struct Discrete {
  double white_sd = 0;  // of a sample
  double step_sd = 0;   // of the bias, a step
  double keep = 1;      // the bias of the sample before is multiplied by this
  double rate_hz = kRate;
};

std::vector<double> samples(const Discrete& rule, std::uint64_t seed, std::size_t n = kSamples) {
  test::Gaussian gauss(seed);
  std::vector<double> out(n);
  double bias = 0;
  for (double& y : out) {
    bias = rule.keep * bias + rule.step_sd * gauss();
    y = bias + rule.white_sd * gauss();
  }
  return out;
}

NoiseFit fitted(const Discrete& rule, std::uint64_t seed) {
  FitOptions options;
  options.second_opinion = false;
  options.terms = {true, false, true, false, false};
  options.remedies = false;
  return fit_record(samples(rule, seed), rule.rate_hz, nullptr, options);
}

// Within 4.5 standard deviations of the fit's own, which are small enough to tell a factor sqrt(2).
void check_term(const NoiseFit& fit, Term term, double truth) {
  REQUIRE(fit[term].value);
  CAPTURE(static_cast<int>(term), *fit[term].value, truth, fit[term].relative_sd);
  CHECK(fit[term].relative_sd < 0.08);
  CHECK(std::abs(std::log(*fit[term].value / truth)) < 4.5 * fit[term].relative_sd);
}

void recovers(const Discrete& rule, double q, double k, std::uint64_t seed) {
  const NoiseFit fit = fitted(rule, seed);
  check_term(fit, Term::white, q);
  if (k > 0) check_term(fit, Term::walk, k);
}

constexpr double kGyroQ = 1e-3, kGyroK = 1e-3, kAccQ = 2e-2, kAccK = 3e-2;

std::vector<SensorModel> device() {
  return test::imu({known(kGyroQ), {}, known(kGyroK)}, {known(kAccQ), {}, known(kAccK)}, kRate);
}

YAML::Node opencv_yaml(const std::string& text) { return YAML::Load(text.substr(text.find('\n') + 1)); }

}  // namespace

TEST_CASE("simulated: Kalibr, EuRoC and OpenVINS make the densities discrete") {
  const YAML::Node files[] = {YAML::Load(exported("kalibr", device()).text),
                              YAML::Load(exported("euroc", device()).text),
                              opencv_yaml(exported("openvins", device()).text)["imu0"]};
  std::uint64_t seed = 1;
  for (const YAML::Node& file : files) {
    const double rate = (file["update_rate"] ? file["update_rate"] : file["rate_hz"]).as<double>();
    const double root_dt = std::sqrt(1.0 / rate);
    const auto rule = [&](const char* density, const char* walk) {
      return Discrete{file[density].as<double>() / root_dt, file[walk].as<double>() * root_dt, 1, rate};
    };
    recovers(rule("gyroscope_noise_density", "gyroscope_random_walk"), kGyroQ, kGyroK, ++seed);
    recovers(rule("accelerometer_noise_density", "accelerometer_random_walk"), kAccQ, kAccK, ++seed);
  }
}

TEST_CASE("simulated: ORB-SLAM3 multiplies by the root of the frequency and divides the walks by it") {
  const YAML::Node file = opencv_yaml(exported("orbslam3", device()).text);
  const double root = std::sqrt(file["IMU.Frequency"].as<double>());
  recovers({file["IMU.NoiseGyro"].as<double>() * root, file["IMU.GyroWalk"].as<double>() / root}, kGyroQ, kGyroK, 11);
  recovers({file["IMU.NoiseAcc"].as<double>() * root, file["IMU.AccWalk"].as<double>() / root}, kAccQ, kAccK, 12);
}

TEST_CASE("simulated: ROVIO's and FAST-LIO's filters believe of a second what the record has") {
  // What each adds to the variance of the velocity a second, by its own propagation: ROVIO dt vel a step,
  // FAST-LIO dt^2 acc_cov.
  const double dt = 1 / kRate;
  const std::string rovio = exported("rovio", device()).text;
  const YAML::Node fast = YAML::Load(exported("fast-lio", device()).text)["mapping"];
  const auto of_rovio = [&](const char* key) { return std::sqrt(number_after(rovio, key)); };
  const auto of_fast = [&](const char* key) { return std::sqrt(fast[key].as<double>()); };
  recovers({of_rovio("att_0") / std::sqrt(dt), of_rovio("gyb_0") * std::sqrt(dt)}, kGyroQ, kGyroK, 121);
  recovers({of_rovio("vel_0") / std::sqrt(dt), of_rovio("acb_0") * std::sqrt(dt)}, kAccQ, kAccK, 122);
  recovers({of_fast("gyr_cov"), of_fast("b_gyr_cov") * dt}, kGyroQ, kGyroK, 123);
  recovers({of_fast("acc_cov"), of_fast("b_acc_cov") * dt}, kAccQ, kAccK, 124);
}

TEST_CASE("simulated: Basalt's std are densities") {
  const Json file = parse_json(exported("basalt", device()).text, "c")["value0"];
  const double root = std::sqrt(file["imu_update_rate"].get<double>());
  recovers({file["gyro_noise_std"][1].get<double>() * root, file["gyro_bias_std"][1].get<double>() / root}, kGyroQ,
           kGyroK, 21);
  recovers({file["accel_noise_std"][2].get<double>() * root, file["accel_bias_std"][2].get<double>() / root}, kAccQ,
           kAccK, 22);
}

TEST_CASE("simulated: GTSAM divides the covariance by the step, and multiplies that of the bias") {
  const std::string file = exported("gtsam", device()).text;
  const double dt = 1 / kRate;
  recovers({std::sqrt(number_after(file, "p->gyroscopeCovariance") / dt),
            std::sqrt(number_after(file, "p->biasOmegaCovariance") * dt)},
           kGyroQ, kGyroK, 31);
  recovers({std::sqrt(number_after(file, "p->accelerometerCovariance") / dt),
            std::sqrt(number_after(file, "p->biasAccCovariance") * dt)},
           kAccQ, kAccK, 32);
}

TEST_CASE("simulated: ROS covariances are variances of a sample") {
  const YAML::Node file = YAML::Load(exported("ros", device()).text);
  recovers({std::sqrt(file["angular_velocity_covariance"][0].as<double>())}, kGyroQ, 0, 41);
  recovers({std::sqrt(file["linear_acceleration_covariance"][8].as<double>())}, kAccQ, 0, 42);
}

TEST_CASE("simulated: MATLAB, double-sided") {
  const std::string file = exported("matlab", device()).text;
  const std::string accel = file.substr(file.find("accelparams("));
  const double scale = 1;
  recovers({number_after(file, "'NoiseDensity") * std::sqrt(kRate / scale),
            number_after(file, "'RandomWalk") / std::sqrt(kRate / scale)},
           kGyroQ, kGyroK, 51);
  recovers({number_after(accel, "'NoiseDensity") * std::sqrt(kRate / scale),
            number_after(accel, "'RandomWalk") / std::sqrt(kRate / scale)},
           kAccQ, kAccK, 52);
}

TEST_CASE("simulated: AirSim's random walk of density stability over root tau") {
  const Json imu = parse_json(exported("airsim", device()).text, "s")["DefaultSensors"]["Imu"];
  const auto number = [&](const char* key) { return imu[key].get<double>(); };
  const double root_dt = std::sqrt(1 / kRate), degree = M_PI / 180;
  const double arw = number("AngularRandomWalk") / std::sqrt(3600.0) * degree;
  const double stability = number("GyroBiasStability") / 3600 * degree / std::sqrt(number("GyroBiasStabilityTau"));
  recovers({arw / root_dt, stability * root_dt}, kGyroQ, kGyroK, 61);
  const double vrw = number("VelocityRandomWalk") * 9.80665 / 1e3;
  const double drift = number("AccelBiasStability") * 1e-6 * 9.80665 / std::sqrt(number("AccelBiasStabilityTau"));
  recovers({vrw / root_dt, drift * root_dt}, kAccQ, kAccK, 62);
}

TEST_CASE("simulated: the prediction step of PX4 EKF2 and ArduPilot EK3") {
  const std::string file = exported("px4", device()).text;
  const double dt = 0.01;
  const auto rule = [&](const char* noise, const char* bias) {
    // A step adds (dt noise)^2 to the variance of the angle: as a rate, noise a step of the filter.
    return Discrete{dt * number_after(file, noise) / dt, dt * number_after(file, bias), 1, 1 / dt};
  };
  recovers(rule("EKF2_GYR_NOISE", "EKF2_GYR_B_NOISE"), kGyroQ, kGyroK, 71);
  recovers(rule("EKF2_ACC_NOISE", "EKF2_ACC_B_NOISE"), kAccQ, kAccK, 72);
  recovers(rule("EK3_GYRO_P_NSE", "EK3_GBIAS_P_NSE"), kGyroQ, kGyroK, 73);
  recovers(rule("EK3_ACC_P_NSE", "EK3_ABIAS_P_NSE"), kAccQ, kAccK, 74);
}

namespace {

// The exact step of an Ornstein-Uhlenbeck bias, as Gazebo and RotorS take it.
Discrete ornstein_uhlenbeck(double white_sd, double driving, double correlation_s, double rate_hz = kRate) {
  const double dt = 1 / rate_hz;
  return {white_sd, std::sqrt(-driving * driving * correlation_s / 2 * std::expm1(-2 * dt / correlation_s)),
          std::exp(-dt / correlation_s), rate_hz};
}

// The bias alone: its Allan deviation at tau, with a standard deviation of about 1 %.
double simulated_adev(const Discrete& rule, double tau_s, std::uint64_t seed) {
  const std::vector<double> record = samples(rule, seed, 4000000);
  AllanOptions options;
  options.grid = TauGrid::list;
  options.taus_s = {tau_s};
  options.threads = 1;
  return allan_deviation(record, 1 / rule.rate_hz, options).points.at(0).deviation;
}

}  // namespace

TEST_CASE("simulated: Gazebo's stddev a sample and Ornstein-Uhlenbeck bias, RotorS' densities") {
  const std::string sdf = exported("sdf", device()).text;
  recovers(ornstein_uhlenbeck(number_after(sdf, "stddev"), number_after(sdf, "dynamic_bias_stddev"),
                              number_after(sdf, "dynamic_bias_correlation_time")),
           kGyroQ, kGyroK, 81);
  const std::string rotors = exported("rotors", device()).text;
  const double root_dt = std::sqrt(1 / kRate);
  recovers(ornstein_uhlenbeck(number_after(rotors, "gyroscopeNoiseDensity") / root_dt,
                              number_after(rotors, "gyroscopeBiasRandomWalk"),
                              number_after(rotors, "gyroscopeBiasCorrelationTime")),
           kGyroQ, kGyroK, 82);
  recovers(ornstein_uhlenbeck(number_after(rotors, "accelerometerNoiseDensity") / root_dt,
                              number_after(rotors, "accelerometerRandomWalk"),
                              number_after(rotors, "accelerometerBiasCorrelationTime")),
           kAccQ, kAccK, 83);
}

namespace {

// A device whose record showed a Gauss-Markov process: gyroscope 0.02 rad/s, 30 s; accelerometer 0.3 m/s^2, 12 s.
constexpr double kGyroSigma = 0.02, kGyroTau = 30, kAccSigma = 0.3, kAccTau = 12;

std::vector<SensorModel> with_process() {
  auto models =
      test::imu({known(kGyroQ), at_most(1e-3), at_most(1e-4)}, {known(kAccQ), at_most(1e-2), at_most(1e-3)}, kRate);
  for (SensorModel& m : models) {
    const bool gyro = m.unit == "rad/s";
    m.gauss_markov = {gyro ? kGyroSigma : kAccSigma, gyro ? kGyroTau : kAccTau, {}, {}};
  }
  return models;
}

// y' = -y/T + q w as a consumer steps it has the steady deviation q sqrt(T/2).
void keeps(double driving, double correlation_s, double sigma, double tau_s) {
  CHECK(correlation_s == Approx(tau_s).epsilon(1e-6));
  CHECK(driving * std::sqrt(correlation_s / 2) == Approx(sigma).epsilon(1e-6));
}

}  // namespace

TEST_CASE("a Gauss-Markov process goes to who has one, by the rule of each") {
  const double degree = M_PI / 180;
  const std::string sdf = exported("sdf", with_process()).text;
  keeps(number_after(sdf, "dynamic_bias_stddev"), number_after(sdf, "dynamic_bias_correlation_time"), kGyroSigma,
        kGyroTau);
  const std::string rotors = exported("rotors", with_process()).text;
  keeps(number_after(rotors, "accelerometerRandomWalk"), number_after(rotors, "accelerometerBiasCorrelationTime"),
        kAccSigma, kAccTau);
  const std::string pegasus = exported("pegasus", with_process()).text;
  keeps(number_after(pegasus, "random_walk"), number_after(pegasus, "bias_correlation_time"), kGyroSigma, kGyroTau);
  const std::string gnss = exported("gnss-ins-sim", with_process()).text;
  CHECK(number_after(gnss, "'gyro_b_stability") * degree / 3600 == Approx(kGyroSigma));
  CHECK(number_after(gnss, "'accel_b_corr") == Approx(kAccTau));
  // simulation/noise_b_dyn.m: b <- exp(-dt/T) b + s sqrt(1 - exp(-2 dt/T)) w
  const std::string navego = exported("navego", with_process()).text;
  CHECK(number_after(navego, "imu.gb_dyn") * degree == Approx(kGyroSigma));
  CHECK(number_after(navego, "imu.gb_corr") == Approx(kGyroTau));
  CHECK(number_after(navego, "imu.ab_dyn") * 9.80665e-3 == Approx(kAccSigma));
  CHECK(number_after(navego, "imu.ab_corr") == Approx(kAccTau));
}

TEST_CASE("KF-GINS: one correlation time for all, the driving density of each") {
  const YAML::Node noise = YAML::Load(exported("kf-gins", with_process()).text)["imunoise"];
  const double degree = M_PI / 180, corr_time = noise["corrtime"].as<double>() * 3600;
  CHECK(corr_time == Approx(kGyroTau));
  for (std::size_t i = 0; i < 3; ++i) {
    // Qc of gi_engine.cpp: 2/corr_time * std^2.
    const double gyro = noise["gbstd"][i].as<double>() * degree / 3600;
    const double accel = noise["abstd"][i].as<double>() * 1e-5;
    CHECK(2 / corr_time * gyro * gyro == Approx(2 / kGyroTau * kGyroSigma * kGyroSigma));
    CHECK(2 / corr_time * accel * accel == Approx(2 / kAccTau * kAccSigma * kAccSigma));
    CHECK(noise["arw"][i].as<double>() * degree / 60 == Approx(kGyroQ));
    CHECK(noise["vrw"][i].as<double>() / 60 == Approx(kAccQ));
    CHECK(noise["gsstd"][i].as<double>() == 0);
  }
  CHECK(test::has(exported("kf-gins", with_process()).text, "driving density kept"));
}

TEST_CASE("who only knows a random walk gets the driving density of a Gauss-Markov process, with a sentence") {
  const double driving = kGyroSigma * std::sqrt(2 / kGyroTau);
  const std::string kalibr = exported("kalibr", with_process()).text;
  CHECK(number_after(kalibr, "gyroscope_random_walk") == Approx(driving));
  CHECK(test::has(kalibr, "correlation time of the Gauss-Markov process"));
  const Json airsim = parse_json(exported("airsim", with_process()).text, "s");
  const Json& imu = airsim["DefaultSensors"]["Imu"];
  CHECK(imu["GyroBiasStability"].get<double>() / 3600 * M_PI / 180 /
            std::sqrt(imu["GyroBiasStabilityTau"].get<double>()) ==
        Approx(driving));
  // A walk beside it adds its own density.
  auto models = with_process();
  for (SensorModel& m : models)
    if (m.unit == "rad/s") m.noise[2] = known(driving);
  CHECK(number_after(exported("kalibr", models).text, "gyroscope_random_walk") == Approx(std::sqrt(2.0) * driving));
  ExportOptions longer;
  longer.correlation_s = 120;
  const std::string rotors = exported("rotors", with_process(), longer).text;
  CHECK(number_after(rotors, "gyroscopeBiasRandomWalk") == Approx(driving));
  CHECK(number_after(rotors, "gyroscopeBiasCorrelationTime") == Approx(120));
}

TEST_CASE("simulated: the steps of Pegasus and NaveGo give the coefficients back") {
  const std::string pegasus = exported("pegasus", device()).text;
  const double root_dt = std::sqrt(1 / kRate);
  recovers(ornstein_uhlenbeck(number_after(pegasus, "noise_density") / root_dt, number_after(pegasus, "random_walk"),
                              number_after(pegasus, "bias_correlation_time")),
           kGyroQ, kGyroK, 84);
  const std::string navego = exported("navego", device()).text;
  const double corr = number_after(navego, "imu.gb_corr");
  const double sigma = number_after(navego, "imu.gb_dyn") * M_PI / 180;
  recovers({number_after(navego, "imu.arw") / 60 * M_PI / 180 / root_dt,
            sigma * std::sqrt(1 - std::exp(-2 / kRate / corr)), std::exp(-1 / kRate / corr), kRate},
           kGyroQ, kGyroK, 85);
}

namespace {

// gnss-ins-sim after the correction of its issue 19; numbers of the gyroscope in deg/h and deg/sqrt(h).
Discrete gnss_ins_sim(double white, double stability, double correlation_s, double rate_hz) {
  return {white * std::sqrt(rate_hz), stability * std::sqrt(1 - std::exp(-2 / (rate_hz * correlation_s))),
          1 - 1 / rate_hz / correlation_s, rate_hz};
}

}  // namespace

TEST_CASE("simulated: gnss-ins-sim's steady bias in deg/h") {
  const std::string file = exported("gnss-ins-sim", device()).text;
  const double degree = M_PI / 180;
  recovers(
      gnss_ins_sim(number_after(file, "'gyro_arw") * degree / 60,
                   number_after(file, "'gyro_b_stability") * degree / 3600, number_after(file, "'gyro_b_corr"), kRate),
      kGyroQ, kGyroK, 91);
  recovers(gnss_ins_sim(number_after(file, "'accel_vrw") / 60, number_after(file, "'accel_b_stability"),
                        number_after(file, "'accel_b_corr"), kRate),
           kAccQ, kAccK, 92);
}

TEST_CASE("simulated: the maximum that stands for flicker reaches its floor where it should") {
  auto models = test::imu({known(1e-4), known(1e-2), at_most(1e-5)}, {known(1e-3), known(0.1), at_most(1e-4)}, 20);
  ExportOptions options;
  options.floor_tau_s = 5;
  const double gyroscope_floor = 0.66428 * 1e-2, accelerometer_floor = 0.66428 * 0.1;
  const std::string sdf = exported("sdf", models, options).text;
  const double tolerance = 0.04;  // four standard deviations
  CHECK(simulated_adev(ornstein_uhlenbeck(0, number_after(sdf, "dynamic_bias_stddev"),
                                          number_after(sdf, "dynamic_bias_correlation_time"), 20),
                       5, 101) == Approx(gyroscope_floor).epsilon(tolerance));
  const std::string rotors = exported("rotors", models, options).text;
  CHECK(simulated_adev(ornstein_uhlenbeck(0, number_after(rotors, "accelerometerRandomWalk"),
                                          number_after(rotors, "accelerometerBiasCorrelationTime"), 20),
                       5, 102) == Approx(accelerometer_floor).epsilon(tolerance));
  const std::string gnss = exported("gnss-ins-sim", models, options).text;
  CHECK(simulated_adev(gnss_ins_sim(0, number_after(gnss, "'gyro_b_stability") * M_PI / 180 / 3600,
                                    number_after(gnss, "'gyro_b_corr"), 20),
                       5, 103) == Approx(gyroscope_floor).epsilon(tolerance));
}

namespace {

// VINS, one axis at rest: the state (position, velocity, bias) of its midpoint step with its F and
// V, noise = (acc at the begin, acc at the end, bias). Returns the standard deviations of velocity
// and bias that it believes after n steps.
std::pair<double, double> vins_belief(double acc_n, double acc_w, double dt, int n) {
  double vv = 0, vb = 0, bb = 0;
  for (int i = 0; i < n; ++i) {
    // v' = v - b dt + dt/2 n0 + dt/2 n1;  b' = b + dt w
    const double next_vv = vv - 2 * dt * vb + dt * dt * bb + 2 * (dt / 2) * (dt / 2) * acc_n * acc_n;
    const double next_vb = vb - dt * bb;
    bb += dt * dt * acc_w * acc_w;
    vv = next_vv;
    vb = next_vb;
  }
  return {std::sqrt(vv), std::sqrt(bb)};
}

// What really happens: midpoint integration of samples with white noise N, and of a bias that walks with K.
std::pair<double, double> vins_truth(double q, double k, double dt, int n, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  double velocity2 = 0, bias2 = 0;
  const int runs = 20000;
  for (int run = 0; run < runs; ++run) {
    double velocity = 0, bias = 0, before = q / std::sqrt(dt) * gauss();
    for (int i = 0; i < n; ++i) {
      const double now = q / std::sqrt(dt) * gauss();
      velocity += (before + now) / 2 * dt;
      before = now;
      bias += k * std::sqrt(dt) * gauss();
    }
    velocity2 += velocity * velocity;
    bias2 += bias * bias;
  }
  return {std::sqrt(velocity2 / runs), std::sqrt(bias2 / runs)};
}

}  // namespace

TEST_CASE("simulated: VINS believes what is true with N sqrt(2f) and K sqrt(f), and with nothing else") {
  const double q = 2e-3, k = 1e-3, f = 200;
  const std::string file = exported("vins", test::imu({known(q), {}, known(k)}, {known(q), {}, known(k)}, f)).text;
  const auto truth = vins_truth(q, k, 1 / f, 200, 111);
  CHECK(truth.first == Approx(2e-3).epsilon(0.02));
  CHECK(truth.second == Approx(1e-3).epsilon(0.02));
  for (const char* sensor : {"acc", "gyr"}) {
    const double n = number_after(file, std::string(sensor) + "_n"), w = number_after(file, std::string(sensor) + "_w");
    CHECK(vins_belief(n, 0, 1 / f, 200).first == Approx(truth.first).epsilon(0.02));
    CHECK(vins_belief(n, w, 1 / f, 200).second == Approx(truth.second).epsilon(0.02));
  }
  // What users tried (issues 102, 167, 233, 280, 327): docs/exports.md has the rule.
  CHECK(vins_belief(q, 0, 1 / f, 200).first == Approx(1.0e-4).epsilon(0.01));
  CHECK(vins_belief(q * std::sqrt(f), 0, 1 / f, 200).first == Approx(1.414e-3).epsilon(0.01));
  CHECK(vins_belief(0, k / std::sqrt(f), 1 / f, 200).second == Approx(5e-6).epsilon(0.01));
  CHECK(vins_belief(0, k, 1 / f, 200).second == Approx(7.07e-5).epsilon(0.01));
}
