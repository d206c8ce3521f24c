// Files laid out byte by byte as the exporters of the field write them: each is read right at the
// first try, names, units, rate, stamps and values checked, or refused with the sentence that leads
// to the right command. None is read wrong in silence.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/log/log_text.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr std::int64_t kNoStart = -1;

struct Export {
  std::string name;
  std::string bytes;
  std::string channels;  ///< "gyro_x[rad/s] temp[]", in order
  double rate_hz = 0;    ///< 0: not known
  std::int64_t start_ns = kNoStart;
  std::vector<double> first;  ///< values of the first sample
  std::string said;           ///< of the guesses and the dialect, or of the refusal
  bool refused = false;
  std::function<void(ReadOptions&)> with = nullptr;
};

// `rows` lines of a table, made by `line(k)`.
template <class Line>
std::string lines(int rows, Line line) {
  std::string out;
  for (int k = 0; k < rows; ++k) out += line(k);
  return out;
}

std::string channels_of(const LogInfo& info) {
  std::string out;
  for (const Channel& c : info.channels) out += (out.empty() ? "" : " ") + c.name + "[" + c.unit + "]";
  return out;
}

std::string said_by(const LogInfo& info) {
  std::string out;
  for (const auto& text : info.dialect) out += text + "\n";
  for (const auto& text : info.guesses) out += text + "\n";
  for (const Finding& w : info.warnings.list()) out += w.code + ": " + w.sentence + "\n";
  return out;
}

std::vector<Export> robot_exports() {
  std::vector<Export> out;
  out.push_back({"rostopic echo -p, sensor_msgs/Imu",
                 "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angular_velocity.x,field."
                 "linear_acceleration.z\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("{},{},{},imu_link,{},9.81\n",
                                                1700000000000000000 + 10000000LL * k + (k * k * 79190) % 900000,
                                                100 + k, 1700000000000000000 + 10000000LL * k, 0.25 + k);
                           }),
                 "time[] field.header.seq[] field.angular_velocity.x[] field.linear_acceleration.z[]",
                 100,
                 1700000000000000000,
                 {1.7e18, 100, 0.25, 9.81},
                 "field.header.stamp, the device's own clock, not time"});
  out.push_back({"ros2 topic echo --csv, sensor_msgs/Imu",
                 lines(12,
                       [](int k) {
                         const std::int64_t ns = 950000000 + 10000000LL * k;
                         return fmt::format("{},{},imu_link,0.0,0.0,{},9.81\n", 1700000000 + ns / 1000000000,
                                            ns % 1000000000, 0.5 + k);
                       }),
                 "c1[] c2[] c3[] c4[]",
                 100,
                 1700000000950000000,
                 {0, 0, 0.5, 9.81},
                 "stamps: seconds in c0 and nanoseconds in c1"});
  out.push_back({"bagpy",
                 "Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,angular_velocity.x\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("1700000000.{:06d},{},1700000000,{},imu,{}\n",
                                                10000 * k + 1000 + (k * 97) % 1000, k, 10000000 * k, k * 0.5);
                           }),
                 "Time[] header.seq[] angular_velocity.x[]",
                 100,
                 1700000000000000000,
                 {1700000000.001, 0, 0},
                 "header.stamp.secs, the device's own clock, not Time"});
  out.push_back({"EuRoC",
                 "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],a_RS_S_x [m s^-2]\r\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("{},-0.099134701513277898,{},8.1\r\n",
                                                1403636579758555392 + 5000000LL * k, k);
                           }),
                 "w_RS_S_x[rad s^-1] w_RS_S_y[rad s^-1] a_RS_S_x[m s^-2]",
                 200,
                 1403636579758555392,
                 {-0.099134701513277898, 0, 8.1},
                 "header in line 1"});
  out.push_back(
      {"TUM RGB-D accelerometer.txt",
       "# accelerometer data\n# file: 'rgbd_dataset.bag'\n# timestamp ax ay az\n" +
           lines(12, [](int k) { return fmt::format("1305031102.{:06d} 0.1 {} 9.8\n", 100000 + 2000 * k, k); }),
       "ax[] ay[] az[]",
       500,
       1305031102100000000,
       {0.1, 0, 9.8},
       "delimiter blanks"});
  out.push_back(
      {"Kalibr imu0.csv",
       "timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z\n" +
           lines(12, [](int k) { return fmt::format("{},{},0,0,0,0,9.8\n", 1385030208736607488 + 5000000LL * k, k); }),
       "omega_x[] omega_y[] omega_z[] alpha_x[] alpha_y[] alpha_z[]",
       200,
       1385030208736607488,
       {0, 0, 0, 0, 0, 9.8},
       "time unit: ns"});
  out.push_back(
      {"PX4 ulog2csv sensor_combined",
       "timestamp,gyro_rad[0],gyro_rad[1],gyro_integral_dt,accelerometer_timestamp_relative,accelerometer_m_s2[0],"
       "magnetometer_ga[2]\n" +
           lines(12, [](int k) { return fmt::format("{},0.01,{},4000,0,-0.2,0.31\n", 112574307 + 4000 * k, k); }),
       "gyro[0][rad/s] gyro[1][rad/s] gyro_integral_dt[] accelerometer_timestamp_relative[] accelerometer[0][m/s2] "
       "magnetometer[2][Gauss]",
       250,
       112574307000,
       {0.01, 0, 4000, 0, -0.2, 0.31},
       "taken as us"});
  out.push_back({"ArduPilot mavlogdump --format csv --types IMU",
                 "timestamp,TimeUS,I,GyrX,GyrY,AccZ,T\n" + lines(12,
                                                                 [](int k) {
                                                                   return fmt::format(
                                                                       "1700000000.{:06d},{},0,0.001,{},-9.8,41.5\n",
                                                                       40000 * k, 254633000 + 40000 * k, k);
                                                                 }),
                 "I[] GyrX[] GyrY[] AccZ[] T[]",
                 25,
                 1700000000000000000,
                 {0, 0.001, 0, -9.8, 41.5},
                 "left out columns that repeat the clock: TimeUS"});
  out.push_back({"Betaflight blackbox_decode",
                 "loopIteration, time (us), gyroADC[0], gyroADC[1], accSmooth[2], flightModeFlags (flags), "
                 "failsafePhase (flags)\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("{}, {}, 3, {}, 2050, ANGLE_MODE, IDLE\n", k * 4, 91734000 + 500 * k,
                                                k);
                           }),
                 "loopIteration[] gyroADC[0][] gyroADC[1][] accSmooth[2][]",
                 2000,
                 91734000000,
                 {0, 3, 0, 2050},
                 "left out columns of words: flightModeFlags"});
  out.push_back({"Blackbox Explorer export",
                 "\"Product\",\"Blackbox flight data recorder by Nicholas Sherlock\"\n\"Data version\",\"2\"\n"
                 "\"looptime\",\"125\"\n\"gyro_scale\",\"0x3f800000\"\n"
                 "\"loopIteration\",\"time\",\"gyroADC[0]\",\"gyroADC[1]\"\n" +
                     lines(40, [](int k) { return fmt::format("{},{},5,{}\n", k, 1000000 + 500 * k, k); }),
                 "loopIteration[] gyroADC[0][] gyroADC[1][]",
                 2000,
                 1000000000,
                 {0, 5, 0},
                 "4 lines before the table left out"});
  return out;
}

std::vector<Export> phone_exports() {
  std::vector<Export> out;
  const auto phyphox = [](char delimiter, bool comma) {
    return lines(12, [=](int k) {
      std::string row = fmt::format("{:.9E}{}{:.9E}{}{:.9E}\n", 0.01 * k, delimiter, 0.5 + k, delimiter, 9.81);
      if (comma) std::replace(row.begin(), row.end(), '.', ',');
      return row;
    });
  };
  out.push_back({"phyphox, comma",
                 "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration z (m/s^2)\"\n" + phyphox(',', false),
                 "Acceleration x[m/s^2] Acceleration z[m/s^2]",
                 100,
                 0,
                 {0.5, 9.81},
                 "header in line 1"});
  out.push_back({"phyphox, tab",
                 "\"Time (s)\"\t\"Acceleration x (m/s^2)\"\t\"Acceleration z (m/s^2)\"\n" + phyphox('\t', false),
                 "Acceleration x[m/s^2] Acceleration z[m/s^2]",
                 100,
                 0,
                 {0.5, 9.81},
                 "delimiter tab"});
  out.push_back({"phyphox, semicolon and decimal comma",
                 "\"Time (s)\";\"Acceleration x (m/s^2)\";\"Acceleration z (m/s^2)\"\n" + phyphox(';', true),
                 "Acceleration x[m/s^2] Acceleration z[m/s^2]",
                 100,
                 0,
                 {0.5, 9.81},
                 "decimal comma"});
  out.push_back({"Sensor Logger, Gyroscope.csv",
                 "time,seconds_elapsed,z,y,x\n" + lines(12,
                                                        [](int k) {
                                                          return fmt::format("{},{:.9f},0.01,{},0.03\n",
                                                                             1714564800123000000 + 10000000LL * k,
                                                                             0.0853 + 0.01 * k, k);
                                                        }),
                 "z[] y[] x[]",
                 100,
                 1714564800123000000,
                 {0.01, 0, 0.03},
                 "left out columns that repeat the clock: seconds_elapsed"});
  out.push_back({"AndroSensor",
                 "sep=;\nACCELEROMETER X (m/s²);GYROSCOPE Z (rad/s);Satellites in range;Time since start in ms "
                 ";YYYY-MO-DD HH-MI-SS_SSS\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("0.1;{};{} / 18;{};2024-05-01 12:00:0{}:{:03d}\n", k, k, 5 + 100 * k,
                                                k / 10, (100 * k) % 1000);
                           }),
                 "ACCELEROMETER X[m/s²] GYROSCOPE Z[rad/s]",
                 10,
                 5000000,
                 {0.1, 0},
                 "Time since start in ms, not YYYY-MO-DD HH-MI-SS_SSS"});
  out.push_back({"Physics Toolbox Sensor Suite",
                 "time,gFx,gFy,gFz,\n" +
                     lines(12, [](int k) { return fmt::format("{:.4f},0.01,{},0.99,\n", 0.0051 + 0.005 * k, k); }),
                 "gFx[g] gFy[g] gFz[g]",
                 200,
                 5100000,
                 {0.01, 0, 0.99},
                 "trailing_delimiter"});
  out.push_back({"Physics Toolbox, clock times",
                 "time;wx (rad/s);wy (rad/s)\n" +
                     lines(12, [](int k) { return fmt::format("23:59:59:{:03d};0,02;{}\n", 10 * k, k); }),
                 "wx[rad/s] wy[rad/s]",
                 100,
                 (std::int64_t{86399}) * 1000000000,
                 {0.02, 0},
                 "stamps are times of day"});
  out.push_back({"Sensor Logger, all sensors in one file",
                 "sensor,time,seconds_elapsed,x,y,z\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("{},{},{:.3f},{},0.2,0.3\n", k % 2 == 0 ? "Accelerometer" : "Gyroscope",
                                                1714564800000000000 + 10000000LL * (k / 2) + 3100000 * (k % 2),
                                                0.01 * (k / 2), k);
                           }),
                 "",
                 0,
                 kNoStart,
                 {},
                 "`where` sensor=Accelerometer",
                 true});
  out.push_back({"Sensor Logger, all sensors in one file, --where",
                 "sensor,time,seconds_elapsed,x,y,z\n" +
                     lines(24,
                           [](int k) {
                             return fmt::format("{},{},{:.3f},{},0.2,0.3\n", k % 2 == 0 ? "Accelerometer" : "Gyroscope",
                                                1714564800000000000 + 10000000LL * (k / 2) + 3100000 * (k % 2),
                                                0.01 * (k / 2), k);
                           }),
                 "x[] y[] z[]",
                 100,
                 1714564800003100000,
                 {1, 0.2, 0.3},
                 "time column: time",
                 false,
                 [](ReadOptions& o) { o.kinds.where = {"sensor=Gyroscope"}; }});
  return out;
}

std::vector<Export> imu_exports() {
  std::vector<Export> out;
  const std::string pairs = lines(12, [](int k) { return fmt::format("{} {}\n", k, 7 * k % 5); });
  for (const char* front : {"# fs=250\n", "fs = 250 Hz\n", "# dt: 0.004 s\n", "Sampling frequency [Hz] 250\n",
                            "# Sampling period (ms): 4\n"})
    out.push_back({front, front + pairs, "c0[] c1[]", 250, kNoStart, {0, 0}, "rate 250 Hz from"});
  out.push_back({"a length instead of a rate",
                 "Total time: 48 ms\n" + pairs,
                 "c0[] c1[]",
                 0,
                 kNoStart,
                 {0, 0},
                 "say: \"Total time: 48 ms\""});
  out.push_back(
      {"Xsens MT Manager",
       "// Start Time: Unknown\r\n// Update Rate: 100.0Hz\r\n// Filter Profile: human (46.1)\r\n"
       "PacketCounter\tSampleTimeFine\tYear\tAcc_X\tGyr_X\r\n" +
           lines(12, [](int k) { return fmt::format("{:05d}\t{}\t\t9.81\t{}\r\n", 100 + k, 51214 + 100 * k, k); }),
       "PacketCounter[] Year[] Acc_X[] Gyr_X[]",
       100,
       5121400000,
       {100, NAN, 9.81, 0},
       "time unit: 100us, from the rate of 100 Hz"});
  out.push_back({"Movella DOT",
                 "DeviceTag:,DOT 1\r\nFirmwareVersion:,2.0.0\r\nAppVersion:,v2022.0\r\nSyncStatus:,Synced\r\n"
                 "OutputRate:,60Hz\r\nFilterProfile:,General\r\nMeasurementMode:,Rate quantities (with mag)\r\n"
                 "StartTime:,2022-05-01 12:00:00\r\n\r\n"
                 "PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Gyr_X\r\n" +
                     lines(24, [](int k) { return fmt::format("{},{},0.1,{},9\r\n", k, 1013245 + 16667 * k, k); }),
                 "PacketCounter[] Acc_X[] Acc_Y[] Gyr_X[]",
                 1e6 / 16667,
                 1013245000,
                 {0, 0.1, 0, 9},
                 "time unit: us, from the rate of 60 Hz"});
  out.push_back({"Movella DOT, without its header",
                 "PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Gyr_X\r\n" +
                     lines(24, [](int k) { return fmt::format("{},{},0.1,{},9\r\n", k, 1013245 + 16667 * k, k); }),
                 "PacketCounter[] Acc_X[] Acc_Y[] Gyr_X[]",
                 1e6 / 16667,
                 1013245000,
                 {0, 0.1, 0, 9},
                 "taken as us"});
  out.push_back(
      {"stamps that no unit brings to the stated rate",
       "# Sample Rate: 75 Hz\ntimestamp,x\n" + lines(24, [](int k) { return fmt::format("{},{}\n", 20 * k, k); }),
       "",
       0,
       kNoStart,
       {},
       "the file states 75 Hz, and its stamps step by 20, which is 50 Hz in ms",
       true});
  out.push_back({"Arduino, key=value",
                 lines(12, [](int k) { return fmt::format("t={} ax=0.01 ay={} az=0.98\r\n", 1000 + 20 * k, k); }),
                 "ax[] ay[] az[]",
                 50,
                 1000000000,
                 {0.01, 0, 0.98},
                 "names before the values"});
  out.push_back({"Arduino, key: value",
                 lines(12, [](int k) { return fmt::format("ax: 0.01, ay: {}, az: -0.98\n", k); }),
                 "ax[] ay[] az[]",
                 0,
                 kNoStart,
                 {0.01, 0, -0.98},
                 "names before the values"});
  out.push_back({"Arduino, key: value without commas",
                 lines(12, [](int k) { return fmt::format("ax: 0.01 ay: {} az: -0.98\n", k); }),
                 "ax[] ay[] az[]",
                 0,
                 kNoStart,
                 {0.01, 0, -0.98},
                 "names before the values"});
  out.push_back({"Arduino serial plotter",
                 lines(12, [](int k) { return fmt::format("gx:1.5\tgy:{}\tgz:-2\r\n", k); }),
                 "gx[] gy[] gz[]",
                 0,
                 kNoStart,
                 {1.5, 0, -2},
                 "names before the values"});
  out.push_back({"Arduino serial monitor with timestamps",
                 lines(12, [](int k) { return fmt::format("12:00:00.{:03d} -> 1.5,{},-2\n", 50 * k, k); }),
                 "c0[] c1[] c2[]",
                 20,
                 std::int64_t{43200} * 1000000000,
                 {1.5, 0, -2},
                 "up to ->"});
  out.push_back({"Tera Term log with timestamps",
                 lines(12, [](int k) { return fmt::format("[2024-05-01 12:00:00.{:03d}] 1.5,{},-2\r\n", 50 * k, k); }),
                 "c0[] c1[] c2[]",
                 20,
                 std::int64_t{1714564800} * 1000000000,
                 {1.5, 0, -2},
                 "up to ]"});
  return out;
}

std::vector<Export> bench_exports() {
  std::vector<Export> out;
  const std::vector<std::string> beside = {
      "Record Length,4.0e+01", "Sample Interval,1.0e-04", "Trigger Point,1e+03", ",", "Source,CH1",
      "Vertical Units,V",      "Horizontal Units,s"};
  out.push_back({"nvidia-smi",
                 "timestamp, power.draw [W], utilization.gpu [%], memory.used [MiB], fan.speed [%]\n" +
                     lines(12,
                           [](int k) {
                             return fmt::format("2024/10/30 18:42:3{}.{}00, {}.50 W, {} %, 1024 MiB, [N/A]\n", k / 10,
                                                k % 10, 20 + k, k);
                           }),
                 "power.draw[W] utilization.gpu[%] memory.used[MiB] fan.speed[%]",
                 10,
                 1730313750000000000,
                 {20.5, 0, 1024, kMissing},
                 "units after the numbers"});
  out.push_back({"a thrust stand behind PuTTY",
                 "=~=~=~=~= PuTTY log 2022.03.27 16:13:03 =~=~=~=~=\n" +
                     lines(12, [](int k) { return fmt::format("{}.50lbs, 22.67V, 0.{}5A, inf\n", k % 3, k % 10); }),
                 "c0[lbs] c1[V] c2[A] c3[]",
                 0,
                 kNoStart,
                 {0.5, 22.67, 0.05, kMissing},
                 "units after the numbers"});
  out.push_back({"Torque: a sign of infinity",
                 "Device Time, Speed (km/h), Cost(Instant)\n" +
                     lines(12, [](int k) { return fmt::format("12:00:{:02}.000,{},{}\n", k, k, k % 2 ? "1.5" : "∞"); }),
                 "Speed[km/h] Cost[Instant]",
                 1,
                 43200000000000,
                 {0, kMissing},
                 ""});
  out.push_back({"Nexus of Vicon: devices",
                 "Devices,,,\n2000,,,\n,,Force Plate - Force,\nFrame,Sub Frame,Fx,Fy\n,,N,N\n" +
                     lines(12, [](int k) { return fmt::format("{},{},{},-0.5\n", 1 + k / 20, k % 20, k); }),
                 "Frame[] Sub Frame[] Fx[N] Fy[N]",
                 2000,
                 kNoStart,
                 {1, 0, 0, -0.5},
                 "the rate in line 2"});
  out.push_back({"Nexus of Vicon: trajectories",
                 "Trajectories,,,,,,,\n100,,,,,,,\n,,box:left,,,box:right,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n"
                 ",,mm,mm,mm,mm,mm,mm\n" +
                     lines(12, [](int k) { return fmt::format("{},0,{},2,3,4,5,6.5\n", 1 + k, k); }),
                 "Frame[] Sub Frame[] box:left X[mm] box:left Y[mm] box:left Z[mm] box:right X[mm] box:right Y[mm] "
                 "box:right Z[mm]",
                 100,
                 kNoStart,
                 {1, 0, 0, 2, 3, 4, 5, 6.5},
                 "the rate in line 2"});
  out.push_back({"Tektronix: settings beside the first rows",
                 lines(40,
                       [&](int k) {
                         return fmt::format("{},,{:.5e},{},\n", k < 7 ? beside[static_cast<std::size_t>(k)] : ",",
                                            1e-4 * k - 1e-3, k % 7);
                       }),
                 "c2[] c3[]",
                 1e4,
                 -1000000,
                 {NAN, 0},
                 "left out columns of words: c0, c1"});
  out.push_back({"LabVIEW .lvm, decimal comma",
                 "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\n"
                 "Decimal_Separator\t,\r\nMulti_Headings\tNo\r\nX_Columns\tOne\r\nTime_Pref\tRelative\r\n"
                 "Operator\tme\r\nDate\t2024/05/01\r\nTime\t12:00:00,123\r\n***End_of_Header***\t\r\n\t\r\n"
                 "Channels\t2\t\t\r\nSamples\t20\t20\t\r\nDate\t2024/05/01\t2024/05/01\t\r\n"
                 "Time\t12:00:00,1\t12:00:00,1\t\r\nX_Dimension\tTime\tTime\t\r\nX0\t0,0E+0\t0,0E+0\t\r\n"
                 "Delta_X\t0,001000\t0,001000\t\r\n***End_of_Header***\t\t\t\r\n"
                 "X_Value\tVoltage\tVoltage 1\tComment\r\n" +
                     lines(20, [](int k) { return fmt::format("0,{:06d}\t1,25\t{},5\r\n", 1000 * k, k); }),
                 "Voltage[] Voltage 1[]",
                 1000,
                 0,
                 {1.25, 0.5},
                 "segments of a LabVIEW measurement file"});
  out.push_back({"Excel, German",
                 "Datum;Uhrzeit;Beschleunigung [m/s²];Drehrate [°/s]\r\n" +
                     lines(12, [](int k) { return fmt::format("01.05.2024;12:00:{:02d};9,81;{},5\r\n", k, k); }),
                 "Beschleunigung[m/s²] Drehrate[°/s]",
                 1,
                 std::int64_t{1714564800} * 1000000000,
                 {9.81, 0.5},
                 "calendar stamps"});
  out.push_back({"Excel, German, Zeit [s]",
                 "sep=;\r\nZeit [s];Drehrate [°/s]\r\n" +
                     lines(12, [](int k) { return fmt::format("0,{:02d};{},5\r\n", 5 * k, k); }),
                 "Drehrate[°/s]",
                 20,
                 0,
                 {0.5},
                 "sep= in line 1"});
  out.push_back(
      {"Excel, French",
       "Temps (s);Accélération (m/s²)\r\n" + lines(12, [](int k) { return fmt::format("{},0;-9,81\r\n", k); }),
       "Accélération[m/s²]",
       1,
       0,
       {-9.81},
       "decimal comma"});
  out.push_back({"Excel, American",
                 "Time,\"Pressure, hPa\"\r\n" +
                     lines(24, [](int k) { return fmt::format("5/1/2024 12:{:02d}:00 PM,\"1,013.{}\"\r\n", k, k); }),
                 "Pressure[hPa]",
                 1.0 / 60,
                 std::int64_t{1714564800} * 1000000000,
                 {1013.0},
                 "is read with the month first"});
  out.push_back(
      {"InfluxDB annotated CSV, one field",
       "#group,false,false,true,true,false,false,true,true\r\n"
       "#datatype,string,long,dateTime:RFC3339,dateTime:RFC3339,dateTime:RFC3339,double,string,string\r\n"
       "#default,mean,,,,,,,\r\n,result,table,_start,_stop,_time,_value,_field,_measurement\r\n" +
           lines(12,
                 [](int k) {
                   return fmt::format(
                       ",,0,2024-05-01T00:00:00Z,2024-05-02T00:00:00Z,2024-05-01T12:00:{:02d}.5Z,{},gx,imu\r\n", k,
                       k + 0.25);
                 }),
       "result[] table[] _value[]",
       1,
       std::int64_t{1714564800} * 1000000000 + 500000000,
       {NAN, 0, 0.25},
       "_time"});
  out.push_back({"InfluxDB annotated CSV, two fields side by side",
                 ",result,table,_time,_value,_field\n" + lines(24,
                                                               [](int k) {
                                                                 return fmt::format(
                                                                     ",,{},2024-05-01T12:00:{:02d}Z,{},{}\n", k % 2,
                                                                     k / 2, k, k % 2 == 0 ? "gx" : "gy");
                                                               }),
                 "",
                 0,
                 kNoStart,
                 {},
                 "`where` _field=gx",
                 true});
  out.push_back({"InfluxDB annotated CSV, grouped",
                 ",result,table,_time,_value,_field\n" + lines(24,
                                                               [](int k) {
                                                                 return fmt::format(
                                                                     ",,{},2024-05-01T12:00:{:02d}Z,{},{}\n", k % 2,
                                                                     k / 2, k, k % 2 == 0 ? "gx" : "gy");
                                                               }),
                 "gx[] gy[]",
                 1,
                 std::int64_t{1714564800} * 1000000000,
                 {0, 1},
                 "",
                 false,
                 [](ReadOptions& o) {
                   o.kinds.group_by = "_field";
                   o.channels = {"_value"};
                 }});
  out.push_back(
      {"Grafana",
       "\"Time\",\"gyro x\",\"gyro y\"\n" +
           lines(12,
                 [](int k) { return fmt::format("2024-05-01 12:00:0{}.{:03d},0.5,{}\n", k / 10, 100 * (k % 10), k); }),
       "gyro x[] gyro y[]",
       10,
       std::int64_t{1714564800} * 1000000000,
       {0.5, 0},
       "calendar stamps"});
  out.push_back(
      {"MATLAB writetimetable",
       "Time,gyro_1,gyro_2\n" + lines(12, [](int k) { return fmt::format("01-May-2024 12:00:{:02d},0.5,{}\n", k, k); }),
       "gyro_1[] gyro_2[]",
       1,
       std::int64_t{1714564800} * 1000000000,
       {0.5, 0},
       "calendar stamps"});
  out.push_back({"pandas to_csv",
                 ",time,gx,status\n" + lines(12,
                                             [](int k) {
                                               return fmt::format("{},2024-05-01 12:00:00.{:02d}0000+02:00,{},OK\n", k,
                                                                  5 * k, 0.5 * k);
                                             }),
                 "gx[]",
                 20,
                 std::int64_t{1714557600} * 1000000000,
                 {0},
                 "left out columns of words: status"});
  out.push_back({"R write.table",
                 "\"t\" \"x\"\n" + lines(12, [](int k) { return fmt::format("\"{}\" {} {}\n", k + 1, 0.5 * k, k); }),
                 "x[]",
                 2,
                 0,
                 {0},
                 "count the rows"});
  out.push_back(
      {"R write.csv",
       "\"t\",\"x, left\"\n" + lines(12, [](int k) { return fmt::format("\"{}\",{},{}\n", k + 1, 0.5 * k, k); }),
       "x, left[]",
       2,
       0,
       {0},
       "count the rows"});
  out.push_back({"PicoScope",
                 "Time,Channel A,Channel B\r\n(ms),(V),(mV)\r\n\r\n" +
                     lines(12, [](int k) { return fmt::format("{:.5f},0.01,{}\r\n", -5.0 + 0.1 * k, k); }),
                 "Channel A[V] Channel B[mV]",
                 10000,
                 -5000000,
                 {0.01, 0},
                 "units in line 2"});
  out.push_back({"Tektronix MSO",
                 "Model,MSO24\r\nFirmware Version,1.44\r\n\r\nWaveform Type,ANALOG,,\r\nHorizontal Units,s,,\r\n"
                 "Sample Interval,1e-05,,\r\nRecord Length,12,,\r\n\r\nLabels,,,\r\nTIME,CH1,CH2\r\n" +
                     lines(20, [](int k) { return fmt::format("{:.6e},0.02,{}\r\n", -1e-4 + 1e-5 * k, k); }),
                 "CH1[] CH2[]",
                 100000,
                 -100000,
                 {0.02, 0},
                 "before the table left out"});
  out.push_back({"Keysight InfiniiVision",
                 "x-axis,1,2\r\nsecond,Volt,Volt\r\n" +
                     lines(12, [](int k) { return fmt::format("{:.6E},0.02,{}\r\n", -5e-3 + 1e-3 * k, k); }),
                 "1[Volt] 2[Volt]",
                 1000,
                 -5000000,
                 {0.02, 0},
                 "units in line 2"});
  out.push_back(
      {"NI DAQExpress",
       "Time,Dev1/ai0 (V),Dev1/ai1 (V)\r\n" +
           lines(12, [](int k) { return fmt::format("2024-05-01 12:00:00.{:06d},0.02,{}\r\n", 1000 * k, k); }),
       "Dev1/ai0[V] Dev1/ai1[V]",
       1000,
       std::int64_t{1714564800} * 1000000000,
       {0.02, 0},
       "calendar stamps"});
  out.push_back({"Dewesoft",
                 "Data file: test.dxd\nSample rate: 500 Hz\nStart time: 01.05.2024 12:00:00\n\n"
                 "Time (s)\tAI 1 (m/s2)\tAI 2 (V)\n" +
                     lines(12, [](int k) { return fmt::format("{:.4f}\t0.02\t{}\n", 0.002 * k, k); }),
                 "AI 1[m/s2] AI 2[V]",
                 500,
                 0,
                 {0.02, 0},
                 "3 lines before the table left out"});
  out.push_back(
      {"Campbell CR1000, TOA5",
       "\"TOA5\",\"st\",\"CR1000\",\"123\",\"CR1000.Std.31\",\"CPU:a.CR1\",\"5\",\"T\"\r\n"
       "\"TIMESTAMP\",\"RECORD\",\"batt_volt\",\"PTemp\"\r\n\"TS\",\"RN\",\"Volts\",\"Deg C\"\r\n"
       "\"\",\"\",\"Min\",\"Smp\"\r\n" +
           lines(12, [](int k) { return fmt::format("\"2024-05-01 12:{:02d}:00\",{},12.5,\"NAN\"\r\n", k, k); }) +
           "\"2024-05-01 12:12:00\",12,12.5,21.5\r\n",
       "RECORD[] batt[volt] PTemp[Deg C]",
       1.0 / 60,
       std::int64_t{1714564800} * 1000000000,
       {0, 12.5, NAN},
       "units in line 3"});
  out.push_back(
      {"HOBO",
       "\"Plot Title: 10012345\"\r\n\"#\",\"Date Time, GMT+02:00\",\"Temp, °C (LGR S/N: 10012345)\",\"Stopped (LGR "
       "S/N: 10012345)\"\r\n" +
           lines(24, [](int k) { return fmt::format("{},05/13/24 01:{:02d}:00 PM,21.{:03d},\r\n", k + 1, k, k); }),
       "Temp[°C] Stopped[]",
       1.0 / 60,
       std::int64_t{1715605200} * 1000000000,
       {21, NAN},
       "calendar stamps"});
  out.push_back(
      {"Stable32",
       "# File: PHASE.DAT\r\n# Tau: 1.0\r\n" + lines(12, [](int k) { return fmt::format("{:.6e}\r\n", 1e-9 * k); }),
       "c0[]",
       1,
       kNoStart,
       {0},
       "no header"});
  out.push_back(
      {"a temperature called t beside the stamps",
       "t,clock_ms,gx\n" + lines(12, [](int k) { return fmt::format("{},{},{}\n", 24 + (k % 3) * 0.1, 10 * k, k); }),
       "t[] gx[]",
       100,
       0,
       {24, 0},
       "time column: clock",
       false,
       nullptr});
  out.push_back({"a torque t with its unit, stamps behind",
                 "t [N·m],timestamp,gx\n" +
                     lines(12, [](int k) { return fmt::format("{},{},{}\n", 1 + 0.1 * k, 1700000000000 + 10 * k, k); }),
                 "t[N·m] gx[]",
                 100,
                 std::int64_t{1700000000} * 1000000000,
                 {1, 0},
                 "time unit: ms"});
  out.push_back({"days with the day first, which the data say",
                 "date,x\n" + lines(20, [](int k) { return fmt::format("{:02d}/05/2024 00:00,{}\n", k + 1, k); }),
                 "x[]",
                 1.0 / 86400,
                 std::int64_t{1714521600} * 1000000000,
                 {0},
                 "calendar stamps"});
  return out;
}

std::vector<Export> microcontroller_exports() {
  std::vector<Export> out;
  constexpr std::int64_t kSecond = 1000000000;
  out.push_back({"VMU931 without a header: the name of the sensor, its clock, its values",
                 lines(24, [](int k) { return fmt::format("acceleration,{},0.01,{}\n", 411480 + 5 * k, k % 7); }),
                 "c1[] c2[]",
                 200,
                 411480 * std::int64_t{1000000},
                 {0.01, 0},
                 "time column: c1, because it rises evenly"});
  out.push_back({"VMU931 of two sensors in turns",
                 lines(48,
                       [](int k) {
                         return fmt::format("{},{},0.01,{}\n", k % 2 == 0 ? "acceleration" : "gyroscopes",
                                            411480 + k / 2 * 5, k);
                       }),
                 "",
                 0,
                 kNoStart,
                 {},
                 "`where` c0=acceleration",
                 true});
  out.push_back({"VMU931 of two sensors in turns, one of them",
                 lines(48,
                       [](int k) {
                         return fmt::format("{},{},0.01,{}\n", k % 2 == 0 ? "acceleration" : "gyroscopes",
                                            411480 + k / 2 * 5, k);
                       }),
                 "acceleration_c1[] acceleration_c2[] gyroscopes_c1[] gyroscopes_c2[]",
                 200,
                 411480 * std::int64_t{1000000},
                 {0.01, 0, 0.01, 1},
                 "time column: c1, because it rises evenly",
                 false,
                 [](ReadOptions& options) { options.kinds.group_by = "c0"; }});
  out.push_back(
      {"milliseconds since 1970 with a pause, without a header",
       lines(40, [](int k) { return fmt::format("{},{},0.5,\n", 1723696181000 + 10 * k + (k > 5 ? 3000 : 0), k % 7); }),
       "c0[] c1[]",
       100,
       1723696181 * kSecond,
       {0, 0.5},
       "because it counts the time since 1970"});
  out.push_back({"a logger of five minutes, seconds since 1970, without a header",
                 lines(24, [](int k) { return fmt::format("{},12.9{},32\n", 1594113901 + 300 * k, k % 10); }),
                 "c0[] c1[]",
                 1.0 / 300,
                 1594113901 * kSecond,
                 {12.9, 32},
                 "time unit: s"});
  out.push_back({"cells between bars",
                 lines(24, [](int k) { return fmt::format("2024-12-02T11:{:02d}:49-05:00 | {} | up\n", k, 200 + k); }),
                 "c0[]",
                 1.0 / 60,
                 1733155249 * kSecond,
                 {200},
                 "delimiter: |"});
  out.push_back({"WitMotion",
                 "\xEF\xBB\xBFStartTime: 2021-08-11 14:08:06.000\r\naddress\tTime(s)\tax(g)\tT(°)\r\n" +
                     lines(24, [](int k) { return fmt::format("0x50\t 14:08:{:02d}.500\t0.5\t{}\r\n", k, k); }),
                 "ax[g] T[°]",
                 1,
                 (14 * 3600 + 8 * 60) * kSecond + kSecond / 2,
                 {0.5, 0},
                 "left out columns of words: address"});
  out.push_back(
      {"a relative time, and a count of frames that steps by twos",
       "frame,relative_time,x\n" + lines(24, [](int k) { return fmt::format("{},{},{}\n", 2 * k, 20 * k, k % 7); }),
       "frame[] x[]",
       50,
       0,
       {0, 0},
       "taken as ms"});
  out.push_back({"a count of frames alone",
                 "frame,x\n" + lines(24, [](int k) { return fmt::format("{},{}\n", 2 * k, k % 7); }),
                 "frame[] x[]",
                 0,
                 kNoStart,
                 {0, 0},
                 ""});
  out.push_back({"a phone on for two weeks, or seconds of 2010",
                 "timestamp,x\n" + lines(24, [](int k) { return fmt::format("{},{}\n", 1279034942 + 2 * k, k % 7); }),
                 "x[]",
                 0.5,
                 1279034942 * kSecond,
                 {0},
                 "time_unit_guessed"});
  out.push_back({"the newest row first",
                 "time,x\n" + lines(24, [](int k) { return fmt::format("2024-05-01 12:{:02d}:00,{}\n", 59 - k, k); }),
                 "",
                 0,
                 kNoStart,
                 {},
                 "turn the rows round (tac)",
                 true});
  return out;
}

std::string chrony_tracking(int rows) {
  const std::string rule(131, '=');
  return lines(rows, [&](int k) {
    const std::string banner =
        k % 32 > 0
            ? ""
            : rule +
                  "\n   Date (UTC) Time     IP Address   St   Freq ppm   Skew ppm     Offset L Co  Offset sd Rem. "
                  "corr. Root delay Root disp. Max. error\n" +
                  rule + "\n";
    return banner + fmt::format(
                        "2023-04-01 04:{:02d}:{:02d} 203.0.113.15     2     21.770      0.016 {: .3e} N  1  5.378e-07 "
                        "-7.400e-09  1.534e-02  3.472e-04  8.304e-03\n",
                        16 * k / 60, 16 * k % 60, 1e-6 * (k - 3));
  });
}

/// Rows as loggers and languages print them.
std::vector<Export> printed_rows() {
  std::vector<Export> out;
  const auto add = [&](const char* name, const std::function<std::string(int)>& line, const char* channels, double rate,
                       std::int64_t start, std::vector<double> first, const char* said) {
    out.push_back({name, lines(40, line), channels, rate, start, std::move(first), said});
  };
  const auto esp = [](int k) { return fmt::format("I ({}) imu: {}.5 -2\n", 300 + 50 * k, k); };
  const auto colour = [&](int k) { return "\x1B[0;32m" + esp(k).substr(0, esp(k).size() - 1) + "\x1B[0m\n"; };
  add("ESP-IDF", esp, "imu[] c2[]", 20, 300000000, {0.5, -2}, "up to )");
  add(
      "ESP-IDF, commas", [](int k) { return fmt::format("I ({}) MPU: {}.5,-2\n", 300 + 50 * k, k); }, "MPU[] c1[]", 20,
      300000000, {0.5, -2}, "up to )");
  add("ESP-IDF with colours", colour, "imu[] c2[]", 20, 300000000, {0.5, -2}, "colours");
  add(
      "dmesg", [](int k) { return fmt::format("[{:12.6f}] iio: {}.5 -2\n", 12.25 + 0.05 * k, k); }, "iio[] c2[]", 20,
      12250000000, {0.5, -2}, "up to ]");
  add(
      "dmesg -T", [](int k) { return fmt::format("[Wed May  1 12:00:{:02d} 2024] iio: {}.5 -2\n", k, k); },
      "iio[] c2[]", 1, std::int64_t{1714564800} * 1000000000, {0.5, -2}, "up to ]");
  add(
      "Zephyr", [](int k) { return fmt::format("[00:00:{:02d}.250,000] <inf> imu: {}.5 -2\n", k, k); }, "imu[] c3[]", 1,
      250000000, {0.5, -2}, "up to ]");
  add(
      "rospy.loginfo", [](int k) { return fmt::format("[INFO] [{:.6f}]: {}.5 -2\n", 1714564800 + 0.05 * k, k); },
      "c0[] c1[]", 20, std::int64_t{1714564800} * 1000000000, {0.5, -2}, "up to ]");
  add(
      "Fortran, blanks", [](int k) { return fmt::format("  {:.2f}D+00  {}.5D+01  -2.D0\n", 0.05 * k, k); }, "c0[] c1[]",
      20, 0, {5, -2}, "Fortran");
  add(
      "Fortran, small letters", [](int k) { return fmt::format("{:.2f}d+00,{}.5d-01,-2.5d0\n", 0.05 * k, k); },
      "c0[] c1[]", 20, 0, {0.05, -2.5}, "Fortran");
  add(
      "lists of Python", [](int k) { return fmt::format("[{:.2f}, {}.5, -2]\n", 0.05 * k, k); }, "c0[] c1[]", 20, 0,
      {0.5, -2}, "brackets");
  add(
      "tuples of Python", [](int k) { return fmt::format("({:.2f}, {}.5, -2),\n", 0.05 * k, k); }, "c0[] c1[]", 20, 0,
      {0.5, -2}, "brackets");
  add(
      "an array of NumPy, printed",
      [](int k) { return fmt::format("{} {:.2f} {}.5 -2.  ]\n", k == 0 ? "[[" : " [", 0.05 * k, k); }, "c0[] c1[]", 20,
      0, {0.5, -2}, "brackets");
  add(
      "arrays of C", [](int k) { return fmt::format("{{{}, {}.5, -2}},\r\n", 50 * k, k); }, "c0[] c1[]", 20, 0,
      {0.5, -2}, "brackets");
  add(
      "a sentence with a checksum", [](int k) { return fmt::format("$IMU,{},{}.5,-2*5C\n", 50 * k, k); }, "c1[] c2[]",
      20, 0, {0.5, -2}, "checksum");
  add(
      "thousands behind narrow blanks",
      [](int k) {
        return (k == 0 ? "t [s];x\n" : "") + fmt::format("{},{:02d};1\xE2\x80\xAF{:03d},5\n", k / 20, k % 20 * 5, k);
      },
      "x[]", 20, 0, {1000.5}, "typesetting");
  add(
      "logging of Python", [](int k) { return fmt::format("2024-05-01 12:00:{:02d},250 INFO:{}.5,-2\n", k, k); },
      "INFO[] c1[]", 1, std::int64_t{1714564800250} * 1000000, {0.5, -2}, "before the lines");
  add(
      "logging of Python, blanks", [](int k) { return fmt::format("2024-05-01 12:00:{:02d},250 -1.5 {}.5\n", k, k); },
      "c0[] c1[]", 1, std::int64_t{1714564800250} * 1000000, {-1.5, 0.5}, "before the lines");
  add(
      "columns that pandas numbered",
      [](int k) { return (k == 0 ? "0,1,2\n" : "") + fmt::format("{:.2f},{}.5,-2.0\n", 0.05 * k, k); }, "1[] 2[]", 20,
      0, {0.5, -2}, "header in line 1");
  out.push_back({"columns that pandas numbered, behind an index",
                 lines(40, [](int k) { return (k == 0 ? ",0,1\n" : "") + fmt::format("{},{},{}.5\n", k, k % 3, k); }),
                 "0[] 1[]",
                 20,
                 kNoStart,
                 {0, 0.5},
                 "header in line 1",
                 false,
                 [](ReadOptions& o) { o.rate_hz = 20; }});
  add(
      "a count of rows in front of the stamps", [](int k) { return fmt::format("{},{},{}.5\n", k, 50 * k, k); },
      "c0[] c1[]", 20, 0, {0, 0.5}, "c1");
  add(
      "a minimum is no minute",
      [](int k) {
        return (k == 0 ? "TIMESTAMP,Batt_volt_Min\n" : "") + fmt::format("2024-05-01 12:{:02d}:00,12.5\n", k);
      },
      "Batt_volt_Min[]", 1.0 / 60, std::int64_t{1714564800} * 1000000000, {12.5}, "calendar");
  add(
      "stamps of accelerometers of the biobank",
      [](int k) {
        return (k == 0 ? "time,enmo\n" : "") + fmt::format("2024-05-01 14:{:02d}:00.000+0200 [Europe/Berlin],0.5\n", k);
      },
      "enmo[]", 1.0 / 60, std::int64_t{1714564800} * 1000000000, {0.5}, "with their time zone");
  return out;
}

std::vector<Export> clock_exports() {
  constexpr std::int64_t kDay = std::int64_t{86400} * 1000000000,
                         kStart = (std::int64_t{1680307200} + 14400) * 1000000000;
  std::vector<Export> out;
  out.push_back({"chrony, tracking.log",
                 chrony_tracking(80),
                 "stratum[] frequency[ppm] skew[ppm] offset[s] sources[] offset_sd[s] remaining[s] root_delay[s] "
                 "root_dispersion[s] max_error[s]",
                 1.0 / 16,
                 kStart,
                 {2, 21.77, 0.016, -3e-6, 1, 5.378e-07, -7.4e-09, 1.534e-02, 3.472e-04, 8.304e-03},
                 "names and units of chrony's tracking log"});
  out.push_back({"chrony, measurements.log without its header",
                 lines(24,
                       [](int k) {
                         return fmt::format(
                             "2023-04-01 04:{:02d}:30 203.0.113.15    N  2 111 111 1111   6  6 0.00 -4.966e-03  "
                             "2.296e-01  1.577e-05  1.615e-01  7.446e-03 4E49535{} 4B D K\n",
                             k, k % 10);
                       }),
                 "stratum[] tests_1[] tests_2[] tests_3[] poll[] remote_poll[] score[] offset[s] peer_delay[s] "
                 "peer_dispersion[s] root_delay[s] root_dispersion[s]",
                 1.0 / 60,
                 kStart + std::int64_t{30} * 1000000000,
                 {2, 111, 111, 1111, 6, 6, 0, -4.966e-03, 2.296e-01, 1.577e-05, 1.615e-01, 7.446e-03},
                 "left out columns of words: source, leap, refid"});
  out.push_back({"chrony, refclocks.log",
                 lines(24,
                       [](int k) {
                         return fmt::format(
                             "2023-04-01 04:00:{:02d}.000000 PPS2    {} N 1  4.900000e-07 {} 1.000e-06\n", k, k % 8,
                             k % 8 == 7 ? "-" : "-6.741777e-07");
                       }),
                 "sample[] pps[] raw_offset[s] offset[s] dispersion[s]",
                 1,
                 kStart,
                 {0, 1, 4.9e-07, -6.741777e-07, 1e-06},
                 "reference clocks"});
  out.push_back({"ntpd, loopstats",
                 lines(24,
                       [](int k) {
                         return fmt::format("61016 {}.878 0.00000{}853 -33.344 0.000003510 0.002074 3\n", 2 + 8 * k,
                                            k % 10);
                       }),
                 "offset[s] frequency[ppm] jitter[s] wander[ppm] time_constant[]",
                 0.125,
                 (61016 - 40587) * kDay + std::int64_t{2878} * 1000000,
                 {8.53e-7, -33.344, 3.51e-6, .002074, 3},
                 "names and units of loopstats"});
  out.push_back({"ntpd, peerstats of one peer",
                 lines(24,
                       [](int k) {
                         return fmt::format("61016 {}.650 192.0.2.1 961a 0.00260{}876 0.010 0.001424877 0.000958674\n",
                                            10847 + 64 * k, k % 10);
                       }),
                 "offset[s] delay[s] dispersion[s] jitter[s]",
                 1.0 / 64,
                 (61016 - 40587) * kDay + std::int64_t{10847650} * 1000000,
                 {.002600876, .010, .001424877, .000958674},
                 "peerstats"});
  const auto at_1_hz = [](ReadOptions& o) { o.rate_hz = 1; };
  out.push_back({"a counter that groups its digits",
                 lines(24, [](int k) { return fmt::format("10,000,000.001,{:03d},{} Hz\r\n", k, k % 10); }),
                 "c0[Hz]",
                 1,
                 kNoStart,
                 {10000000.001},
                 "thousands are separated by ,",
                 false,
                 at_1_hz});
  out.push_back({"a counter that groups its digits by blanks",
                 lines(24, [](int k) { return fmt::format("10 000 000.001 {:03d} Hz\r\n", k); }),
                 "c0[Hz]",
                 1,
                 kNoStart,
                 {10000000.001},
                 "thousands are separated by blanks",
                 false,
                 at_1_hz});
  out.push_back({"columns of whole numbers by blanks are no groups",
                 lines(24, [](int k) { return fmt::format("10 {} 250.5\n", 100 + k % 7); }),
                 "c0[] c1[] c2[]",
                 1,
                 kNoStart,
                 {10, 100, 250.5},
                 "delimiter blanks",
                 false,
                 at_1_hz});
  out.push_back({"a counter of times without a unit",
                 lines(24, [](int k) { return fmt::format("0.000,001,{:03d}\n", k); }),
                 "c0[]",
                 1,
                 kNoStart,
                 {0.000001},
                 "thousands are separated by ,",
                 false,
                 at_1_hz});
  out.push_back({"three columns that look like digits in groups",
                 lines(24, [](int k) { return fmt::format("{},101.325,{}\n", 100 + k, 512 + k % 7); }),
                 "c0[] c1[] c2[]",
                 1,
                 kNoStart,
                 {100, 101.325, 512},
                 "",
                 false,
                 at_1_hz});
  return out;
}

std::vector<Export> printed_messages() {
  std::vector<Export> out;
  const auto ros1 = [](int k) {
    return fmt::format(
        "header: \n  seq: {}\n  stamp: \n    secs: 1700000000\n    nsecs: {:>9}\n  frame_id: \"imu, "
        "left\"\norientation: \n"
        "  w: 1.0\nangular_velocity: \n  x: {}\n  y: -1e-05\ncovariance: [{}.5, 0.0]\n---\n",
        k, 5000000 * k, 0.5 + k, k);
  };
  out.push_back(
      {"rostopic echo",
       lines(20, ros1) + "header: \n  seq: 20\n",
       "header.seq[] orientation.w[] angular_velocity.x[] angular_velocity.y[] covariance[0][] covariance[1][]",
       200,
       1700000000000000000,
       {0, 1, 0.5, -1e-5, 0.5, 0},
       "messages that ROS printed"});
  out.push_back({"ros2 topic echo",
                 lines(20,
                       [](int k) {
                         return fmt::format(
                             "header:\n  stamp:\n    sec: 1700000000\n    nanosec: {}\n  frame_id: base\nname:\n- a\n- "
                             "b\nposition:\n- {}.25\n- 2.0\npoints:\n- x: 1.0\n  y: {}\n- x: 3.0\n  y: 4.0\n---\n",
                             10000000 * k, k, k);
                       }),
                 "position[0][] position[1][] points[0].x[] points[0].y[] points[1].x[] points[1].y[]",
                 100,
                 1700000000000000000,
                 {0.25, 2, 1, 0, 3, 4},
                 "left out columns of words: header.frame_id, name[0], name[1]"});
  out.push_back({"ros2 topic echo of numbers without stamps",
                 lines(20, [](int k) { return fmt::format("data: {}.5\n---\n", k); }),
                 "data[]",
                 10,
                 kNoStart,
                 {0.5},
                 "",
                 false,
                 [](ReadOptions& o) { o.rate_hz = 10; }});
  out.push_back({"ros2 topic echo behind a warning, with carriage returns",
                 "WARNING: topic [/imu] does not appear to be published yet\r\n" +
                     lines(20,
                           [](int k) {
                             return fmt::format(
                                 "header:\r\n  stamp:\r\n    sec: 1700000000\r\n    nanosec: {}\r\nz: {}.5\r\n---\r\n",
                                 10000000 * k, k);
                           }),
                 "z[]",
                 100,
                 1700000000000000000,
                 {0.5},
                 "messages that ROS printed"});
  out.push_back({"ros2 topic echo of an array",
                 lines(20,
                       [](int k) {
                         return fmt::format("layout:\n  dim: []\n  data_offset: 0\ndata:\n- {}.5\n- -1.0\n---\n", k);
                       }),
                 "layout.data_offset[] data[0][] data[1][]",
                 10,
                 kNoStart,
                 {0, 0.5, -1},
                 "messages that ROS printed",
                 false,
                 [](ReadOptions& o) { o.rate_hz = 10; }});
  out.push_back({"rostopic echo with a message that is broken",
                 lines(9, ros1) + "WARNING: lost\n---\n" + lines(9, ros1),
                 "",
                 0,
                 kNoStart,
                 {},
                 "(message 10)",
                 true});
  return out;
}

void check_export(const Export& e) {
  ReadOptions options;
  if (e.with) e.with(options);
  for (const std::size_t block : {std::size_t{1} << 21U, std::size_t{64}}) {
    options.block_bytes = block;
    INFO(e.name << ", blocks of " << block);
    if (e.refused) {
      CHECK_THAT(test::failure(e.bytes, options), Catch::Contains(e.said));
      continue;
    }
    Recording r;
    try {
      r = test::read_text(e.bytes, options);
    } catch (const Error& error) {
      FAIL_CHECK(error.what());
      continue;
    }
    CHECK(channels_of(r.info) == e.channels);
    CHECK(r.info.time.rate_hz == Approx(e.rate_hz).epsilon(1e-6));
    CHECK(r.info.time.start_ns.value_or(kNoStart) == e.start_ns);
    CHECK_THAT(said_by(r.info), Catch::Contains(e.said));
    REQUIRE(r.samples.size() == e.first.size());
    for (std::size_t c = 0; c < e.first.size(); ++c) {
      INFO(r.info.channels[c].name);
      CHECK((r.samples[c][0] == e.first[c] || (std::isnan(r.samples[c][0]) && std::isnan(e.first[c]))));
    }
  }
}

}  // namespace

TEST_CASE("robots: files of their exporters are read right at the first try") {
  for (const Export& e : robot_exports()) check_export(e);
}

TEST_CASE("clocks: logs of daemons and counters are read right at the first try") {
  for (const Export& e : clock_exports()) check_export(e);
}

TEST_CASE("rows that loggers and languages print are read right at the first try") {
  for (const Export& e : printed_rows()) check_export(e);
}

TEST_CASE("microcontrollers and their loggers: files are read right at the first try") {
  for (const Export& e : microcontroller_exports()) check_export(e);
}

TEST_CASE("messages that ROS printed are read right at the first try") {
  for (const Export& e : printed_messages()) check_export(e);
}

TEST_CASE("phones: files of their exporters are read right at the first try") {
  for (const Export& e : phone_exports()) check_export(e);
}

TEST_CASE("inertial units: files of their exporters are read right at the first try") {
  for (const Export& e : imu_exports()) check_export(e);
}

TEST_CASE("the bench: files of instruments and tables are read right at the first try") {
  for (const Export& e : bench_exports()) check_export(e);
}
