#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/diagnosis/audit.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// Collects what the checks of one run find.
class AuditNotes {
 public:
  AuditNotes(const DiagnosisCase& of,
             const ArmModel* arm,
             const Recording& run,
             std::vector<Finding>& findings)
      : of_{of}, arm_{arm}, run_{run}, findings_{findings} {}

  /// `row` counts from 0 at the run's first; nothing: the finding is not of a row.
  void add(Severity severity,
           std::string kind,
           std::string column,
           std::optional<std::size_t> row,
           std::string text) const {
    findings_.push_back({.severity = severity,
                         .kind = std::move(kind),
                         .run = run_.name,
                         .file = run_.file.empty() ? run_.name : run_.file,
                         .column = std::move(column),
                         .row = row ? run_.first_row + *row : 0,
                         .text = std::move(text)});
  }

  /// Something fatal of this run is among the findings.
  [[nodiscard]] bool fatal() const noexcept;

  [[nodiscard]] const DiagnosisCase& of() const noexcept { return of_; }
  [[nodiscard]] const ArmModel* arm() const noexcept { return arm_; }  ///< none: a bench
  [[nodiscard]] const Recording& run() const noexcept { return run_; }

 private:
  const DiagnosisCase& of_;
  const ArmModel* arm_;
  const Recording& run_;
  std::vector<Finding>& findings_;
};

[[nodiscard]] std::string position_column(const DiagnosisCase& of, std::size_t axis);
[[nodiscard]] std::string command_column(const DiagnosisCase& of, std::size_t axis);

/// One axis of vectors, as numbers.
[[nodiscard]] std::vector<double> axis_of(const std::vector<JointVector>& rows, std::size_t axis);

/// Smallest step of a reading: the stated one, else the smallest between two rows; 0: it stands.
[[nodiscard]] double quantum_of(const std::vector<double>& q, double stated);

/// @returns false when the time stamps are so wrong that speeds mean nothing.
bool audit_stamps(const AuditNotes& notes);
void audit_columns(const AuditNotes& notes);
void audit_readings(const AuditNotes& notes);
void audit_motion(const AuditNotes& notes);
void audit_currents(const AuditNotes& notes);

}  // namespace teleop
