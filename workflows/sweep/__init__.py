"""Many runs of one workflow that differ in some of its parameters."""
