"""The data: what each word of optplan is. Small frozen values, SI units, nothing else known."""
