"""What happens to a store when processes die, disks fill up and files rot."""
