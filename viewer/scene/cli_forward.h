#pragma once
// CLI11's classes by name, for headers: its own header takes five seconds to compile, so only files that use it include
// it.

namespace CLI {
class App;
class Option;
class Validator;
} // namespace CLI
