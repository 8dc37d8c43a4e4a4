//! The port of a board, as an argument.

use breakaway_core::link::BAUD;

/// Where the board is.
#[derive(clap::Args, Clone, Debug)]
pub struct PortArgs {
    /// Serial port or pseudo-terminal of the board, e.g. /dev/ttyACM0
    #[arg(long, value_name = "PORT")]
    pub port: String,
    /// Baud rate; USB ports and pseudo-terminals ignore it
    #[arg(long, value_name = "BAUD", default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(300..))]
    pub baud: u32,
}
