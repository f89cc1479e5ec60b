"""What all packages share: settings, integer time, seeds, files, errors, commands."""
