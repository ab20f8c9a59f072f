// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tonewright/error.h"

/// The tone mappers of other programs, and the operators that compute the same.
TONEWRIGHT_NAMESPACE_BEGIN

/// A tone mapper of a program in one of its versions, with the result of a measurement.
struct EngineToneMapper {
    enum class Verdict {
        equal,    ///< within 1e-6, or within the program's own rounding, which `note` then names
        nearest,  ///< `op` is the nearest operator, `difference` its distance
        none,     ///< no operator of one pixel computes it; `note` is the reason
    };
    std::string program;  ///< "three.js"
    std::string version;  ///< "0.187.0"
    std::string package;  ///< of npm or Debian, with the version that was executed; or empty
    std::string name;     ///< the program's own name of the tone mapper, "ACESFilmicToneMapping"
    /// Further names by which people ask for it, without the program's: "ACES".
    std::vector<std::string> names;
    Verdict verdict = Verdict::none;
    /// A text for resolve_operator(); empty if there is none.
    std::string op;
    /// Order of exposure, curve, clamp and encoding in the program.
    std::string order;
    /// Largest difference of the program from `op`; none where nothing was compared.
    std::optional<double> difference;
    /// Unit of `difference`: "display-linear", "code values" (0 to 1) or "8-bit codes" (0 to 255).
    std::string unit;
    /// Both were clamped to [0, 1], as a display of this range does. False: as they come out.
    bool is_clamped = false;
    /// The encoding in which both were compared: an id of a display, `linear` or `native`.
    std::string display;
    std::string measured;  ///< the day of the measurement, "2026-11-28"
    std::string note;      ///< further facts, without a full stop; may be empty
};

/// All of them, the rows of a program together; its newest version first.
[[nodiscard]] TONEWRIGHT_API const std::vector<EngineToneMapper>& engine_tone_mappers();

/// "equal", "nearest", "none"
[[nodiscard]] TONEWRIGHT_API std::string_view name_of(EngineToneMapper::Verdict verdict);

/// The tone mapper that a text names with its program: "Babylon.js Standard", "threejs aces
/// filmic". Case, blanks and punctuation do not count, nor does a final ".js" of the program. Null:
/// none. Of several versions, the first row.
[[nodiscard]] TONEWRIGHT_API const EngineToneMapper* find_engine_tone_mapper(std::string_view name);

/// A tone mapper that a name without a program may mean.
struct NameMeaning {
    std::string op;                 ///< operator text; empty: no operator computes it
    std::vector<std::string> uses;  ///< "three.js ACESFilmicToneMapping", or the operator's title
};
/// All meanings of such a name ("ACES"): those of the programs, then operators that have it in
/// their id. Empty if no program uses the name.
[[nodiscard]] TONEWRIGHT_API std::vector<NameMeaning> meanings_of(std::string_view name);
/// The names with several meanings that resolve_operator() refuses, for documents.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& ambiguous_names();

/// A fact about a name that resolve_operator() accepts and that a user may not expect, such as
/// another program's tone mapper of the same name. Empty: none. May refer to lists. @see render
[[nodiscard]] TONEWRIGHT_API std::string note_on_name(std::string_view text);

/// A name that means tone mappers of several programs. @see meanings_of
class TONEWRIGHT_API AmbiguousNameError : public Error {
  public:
    AmbiguousNameError(const Problem& problem, std::string name)
        : Error(problem), name_(std::move(name)) {}
    [[nodiscard]] const std::string& name() const noexcept { return name_; }

  private:
    std::string name_;
};

TONEWRIGHT_NAMESPACE_END
